// How often a rule of traversal is on the branch that the model is on, and how far the force that
// it sends is off.
//
//   bench_branches GRID MODELS RIGHT [PATHS] [SEED] [OF]
//
// MODELS is the directory of the plug-ins. Each of PATHS (20) is a smooth way of 2,000 ticks or
// more from one touched place to the next, 20 ticks a spacing. OF is the grid whose touched places
// and spacing the paths have, for the same paths in grids of several spacings (GRID). Each path is
// followed by each rule, and by the model itself, asked 32 times a spacing. A tick is right when
// the spheres that show the state are within RIGHT (root mean square, the model's unit of length)
// of the model's. Only ticks are counted in which the model pushes the hand.
//
// A line for each rule: its name, ticks that count, % of them right, the 99th percentile of the
// force's error in newtons. The rules:
//   paper   with the force of the interpolated state, as play sends it then
//   branch  the grid alone, with the gradient of the interpolated energy, as all that follow
//   beside  the same with the model beside it, whose answers are one tick late, as for a live hand.
//           In time they would be the very states with which all rules are compared.
//   late    and with answers that are 5 ticks late
#include <array>
#include <cstdlib>
#include <memory>
#include <optional>

#include "libcore/base/error.hpp"
#include "libcore/follow/beside.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "libcore/follow/record_fields.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/model/fields.hpp"
#include "tests/bench/bench.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

constexpr double kContact = 1e-6;  // newtons
constexpr double kTicksASpacing = 20, kRateHz = 1000;
constexpr std::size_t kTicks = 2000;  // of a path, the least

/// The places of a grid where the model pushes by a force that is felt.
std::vector<PointIndex> touched_places(const Grid& grid, const std::vector<Vec3>& force) {
  std::vector<PointIndex> touched;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const double newtons = distance(force[r], {0, 0, 0});
    if (newtons >= 0.02 && newtons <= 2.5) touched.push_back(grid.point(r));
  }
  if (touched.empty()) throw Error("this grid has nothing to touch");
  return touched;
}

/// A uniform cubic B-spline through such places, each moved by up to 0.7 spacings along each axis.
std::vector<Vec3> touch(const Box& box, const std::vector<PointIndex>& touched,
                        std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto place = [&] {
    Vec3 x = box.position(touched[random() % touched.size()]);
    for (int a = 0; a < 3; ++a) {
      x[a] += box.spacing * uniform(random, -0.7, 0.7);
      x[a] = std::clamp(x[a], box.origin[a], box.high()[a]);
    }
    return x;
  };
  std::array<Vec3, 4> p{place(), place(), place(), place()};
  const auto at = [&](double t) {
    const double w[] = {(1 - t) * (1 - t) * (1 - t) / 6, (3 * t * t * t - 6 * t * t + 4) / 6,
                        (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6, t * t * t / 6};
    return w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3] * p[3];
  };
  std::vector<Vec3> path;
  while (path.size() < kTicks) {
    for (double t = 0; t < 1;) {
      path.push_back(at(t));
      const double speed = distance(at(t + 1e-4), at(t)) / 1e-4;
      t += std::min(0.05, box.spacing / kTicksASpacing / std::max(speed, 1e-9));
    }
    p = {p[1], p[2], p[3], place()};
  }
  return path;
}

/// What a tick was like.
struct Felt {
  std::vector<double> row;
  Vec3 force{0, 0, 0};
};

/// What all rules have of a grid.
struct Played {
  Played(const Grid& grid, const MakeModel& make)
      : map(std::make_shared<const BranchNodes>(grid)),
        records(record_fields(grid, make, 1)),
        energies(std::make_shared<const NodeEnergies>(node_energies(grid, records, map.get()))),
        interpolate(!records.energy.empty() && agreement(grid, records).is_good() ? hermite_force
                                                                                  : mean_force),
        fields(grid.spec(), make, true) {}

  std::shared_ptr<const BranchNodes> map;
  RecordFields records;
  std::shared_ptr<const NodeEnergies> energies;
  NodeForce::Interpolate interpolate;
  Fields fields;
};

/// Root mean square of the differences of the spheres.
double rms(const Fields& fields, std::span<const double> a, std::span<const double> b) {
  const std::size_t spheres = fields.spheres().size();
  std::vector<float> p(3 * spheres), q(3 * spheres);
  fields.shape({}, a, p);  // of molecules, which do not need the HIP
  fields.shape({}, b, q);
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += (p[i] - q[i]) * (p[i] - q[i]);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, spheres)));
}

class Rule {
 public:
  /// @param late by how many ticks answers of the model beside the grid are; nothing: without it
  Rule(const char* name, const Grid& grid, const Played& played, std::unique_ptr<Traversal> by,
       const MakeModel& make = {}, std::optional<std::uint32_t> late = {})
      : name_(name), grid_(grid), played_(played), traversal_(std::move(by)) {
    if (!late) return;
    beside_.emplace(grid_, make(), *late);
    beside_->begin(kRateHz);
    traversal_->walk_beside(&*beside_);
  }

  void follow(const std::vector<Vec3>& path, const std::vector<Felt>& truth, double right) {
    NodeForce force(played_.energies, grid_.box(), played_.interpolate);
    for (std::size_t i = 0; i < path.size(); ++i) {
      go(*traversal_, path, i);
      const std::span<const double> row = traversal_->row();
      const Vec3 sent = traversal_->branch_nodes()
                            ? force(*traversal_)
                            : played_.fields.force(traversal_->position(), row);
      if (!(distance(truth[i].force, {0, 0, 0}) > kContact)) continue;
      errors_.push_back(distance(truth[i].force, sent));
      right_ += rms(played_.fields, truth[i].row, row) <= right;
    }
  }
  void print() {
    const double ticks = static_cast<double>(std::max<std::size_t>(errors_.size(), 1));
    std::printf("%s\t%zu\t%.2f\t%.3f\n", name_, errors_.size(), 100 * right_ / ticks,
                quantile(errors_, 0.99));
  }

 private:
  const char* name_;
  const Grid& grid_;
  const Played& played_;
  std::optional<Beside> beside_;
  std::unique_ptr<Traversal> traversal_;
  std::vector<double> errors_;  // of ticks that count, newtons
  double right_ = 0;            // of those
};

int run(const Grid& grid, int argc, char** argv) {
  const MakeModel make = model_of(grid, argv[2]);
  const double right = std::atof(argv[3]);
  const int paths = argc > 4 ? std::atoi(argv[4]) : 20;
  const std::uint64_t seed = argc > 5 ? std::strtoull(argv[5], nullptr, 10) : 1;
  const Played played(grid, make);
  const std::optional<Grid> other = argc > 6 ? std::optional(load_grid(argv[6])) : std::nullopt;
  const Grid& of = other ? *other : grid;
  const std::vector<PointIndex> touched =
      touched_places(of, other ? record_fields(of, make, 1).force : played.records.force);
  ModelTraversal truth(grid, make());
  const auto by_branch = [&] { return std::make_unique<BranchTraversal>(grid, played.map); };
  std::vector<std::unique_ptr<Rule>> rules;
  rules.push_back(
      std::make_unique<Rule>("paper", grid, played, std::make_unique<PaperTraversal>(grid)));
  rules.push_back(std::make_unique<Rule>("branch", grid, played, by_branch()));
  rules.push_back(std::make_unique<Rule>("beside", grid, played, by_branch(), make, 1));
  rules.push_back(std::make_unique<Rule>("late", grid, played, by_branch(), make, 5));
  for (int p = 0; p < paths; ++p) {
    const std::vector<Vec3> path = touch(of.box(), touched, seed + static_cast<std::uint64_t>(p));
    std::vector<Felt> model;
    for (std::size_t i = 0; i < path.size(); ++i) {
      if (!go(truth, path, i).usable()) throw Error("the model fails on this path");
      const std::span<const double> row = truth.row();
      model.push_back({{row.begin(), row.end()}, played.fields.force(truth.position(), row)});
    }
    for (const auto& rule : rules) rule->follow(path, model, right);
  }
  for (const auto& rule : rules) rule->print();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::main_of(argc, argv, 4, "bench_branches GRID MODELS RIGHT [PATHS] [SEED] [OF]", run);
}
