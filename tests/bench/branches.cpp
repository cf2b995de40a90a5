// How often a rule of traversal is on the branch that the model is on, how far the force that it
// sends is off, and what a step costs.
//
//   bench_branches GRID MODELS KIND RIGHT [PATHS] [SEED] [SPEED] [DELAY] [TICKS] [OF]
//
// MODELS is the directory of the plug-ins. KIND is what the paths are like:
//   touch     smooth ways from one touched place to the next
//   back      pieces of such ways, each there, back and there again
//   smooth    sums of sines through the inner nine tenths of the box
//   straight  there and back along the x axis, in lines of a random place
//   diagonal  there and back between two random places
//   tear-off  from a point with one level along a branch to a place where it ends, and 40 times to
//             and fro within two spacings of it
// Each path has TICKS ticks or more (4000), SPEED of them a spacing (20). OF is the grid whose
// touched places and spacing the paths have, for the same paths in grids of several spacings (GRID;
// not for tear-off). Each path is followed by each
// rule, and by the model itself, asked 32 times a spacing. A tick is right when the spheres that
// show the state are within RIGHT (root mean square, the model's unit of length) of the model's.
// Only ticks are counted in which the model pushes the hand. With RIGHT 0 the model is not asked:
// that leaves the cost.
//
// A line for each rule: kind, rule, ticks that count, % of them right, % in which the force is off
// by at most 0.1 N, the force's error in newtons (median, 99th percentile), snaps, nanoseconds a
// step, the model's conversions included. The rules:
//   paper   with the force of the interpolated state, as play sends it then
//   branch  the grid alone, with the gradient of the interpolated energy, as all that follow
//   beside  the same with the model beside it, whose answers are one tick late, as for a live hand.
//           In time they would be the very states with which all rules are compared.
//   late    and with answers that are DELAY ticks late (5)
//   oracle  of all branches that the cell has, the one nearest to the model's state
//
// For the kind `back`, the lines are: kind, rule, ways in which neither the model nor the rule
// snaps and the model's own force is the same there and back, % of them in which the rule's force
// at one place differs by more than 0.1 N.
#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>

#include "libcore/follow/beside.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "libcore/follow/record_fields.hpp"
#include "libcore/model/fields.hpp"
#include "tests/bench/paths.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

constexpr double kContact = 1e-6;  // newtons
constexpr double kClose = 0.1;     // newtons, between two forces
constexpr double kRateHz = 1000;

/// What a tick was like.
struct Felt {
  std::vector<double> row;
  Vec3 force{0, 0, 0};
  bool snapped = false;
};

struct Figures {
  std::uint64_t ticks = 0, right = 0, close = 0, snaps = 0, steps = 0, ways = 0, ways_apart = 0;
  double nanoseconds = 0;
  std::vector<double> force_error;

  static double percent(std::uint64_t part, std::uint64_t of) {
    return 100.0 * static_cast<double>(part) / static_cast<double>(std::max(of, std::uint64_t{1}));
  }
  void print(const std::string& kind, const char* rule) {
    const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
    if (kind == "back")
      std::printf("%s\t%s\t%llu\t%.2f\n", kind.c_str(), rule, number(ways),
                  percent(ways_apart, ways));
    else
      std::printf("%s\t%s\t%llu\t%.2f\t%.2f\t%.4f\t%.3f\t%llu\t%.1f\n", kind.c_str(), rule,
                  number(ticks), percent(right, ticks), percent(close, ticks),
                  quantile(force_error, 0.5), quantile(force_error, 0.99), number(snaps),
                  nanoseconds / static_cast<double>(std::max(steps, std::uint64_t{1})));
  }
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

class Rule {
 public:
  /// @param delay_ticks of the model beside the grid; -1: the grid alone
  Rule(const char* name, const Grid& grid, const Played& played, std::unique_ptr<Traversal> by)
      : name_(name), grid_(grid), played_(played), traversal_(std::move(by)) {}
  void walk_beside(const MakeModel& make, std::uint32_t delay) {
    beside_.emplace(grid_, make(), delay);
    beside_->begin(kRateHz);
    traversal_->walk_beside(&*beside_);
  }

  void begin_path() {
    force_.emplace(played_.energies, grid_.box(), played_.interpolate);
    felt.clear();
  }
  /// @param path of which tick i comes
  void follow(const std::vector<Vec3>& path, std::size_t i) {
    const StepResult step = go(*traversal_, path, i);
    const std::span<const double> row = traversal_->row();
    felt.push_back({{row.begin(), row.end()}, {}, step.snapped});
    felt.back().force = traversal_->branch_nodes()
                            ? (*force_)(*traversal_)
                            : played_.fields.force(traversal_->position(), row);
  }
  /// The whole path, timed.
  void time(const std::vector<Vec3>& path) {
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < path.size(); ++i) go(*traversal_, path, i);
    const std::chrono::duration<double, std::nano> passed =
        std::chrono::steady_clock::now() - begin;
    figures.nanoseconds += passed.count();
    figures.steps += path.size();
  }
  const char* name() const { return name_; }

  Figures figures;
  std::vector<Felt> felt;  // by tick of the present path

 private:
  const char* name_;
  const Grid& grid_;
  const Played& played_;
  std::optional<Beside> beside_;
  std::unique_ptr<Traversal> traversal_;
  std::optional<NodeForce> force_;
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

/// Of the branches of the cell in which `truth` is, the one nearest to its state.
Felt oracle(const Grid& grid, const Played& played, const Traversal& truth) {
  const Cells cells(grid);
  const BranchNodes& nodes = *played.map;
  const PointIndex base = grid.box().index(truth.cell());
  const std::array<double, 8> weights = corner_weights(truth.part());
  Felt best{std::vector<double>(grid.spec().row_size()), {}, false};
  std::vector<double> row(grid.spec().row_size());
  double least = 1e300;
  for (int k = 0; k < 8; ++k) {
    if (!cells.is_corner(k)) continue;
    const PointIndex point = cells.point(base, k);
    for (RecordIndex level = 0; level < grid.levels(point); ++level) {
      const RecordIndex anchor = grid.first(point) + level;
      NodeCorners corners{};
      std::array<const double*, 8> rows{};
      bool is_whole = true;
      for (int j = 0; j < 8; ++j) {
        const int q = kBetweenCorners[k][cells.distinct(j)];
        const Node node = q < 0 ? anchor : nodes.node(anchor, q);
        is_whole &= node != BranchNodes::kNoNode;
        if (!is_whole) break;
        corners[j] = &(*played.energies)[node];
        rows[j] = nodes.row(node);
      }
      if (!is_whole) continue;
      blend(weights, rows, row);
      const double far = rms(played.fields, row, truth.row());
      if (far >= least) continue;
      least = far;
      best = {row, played.interpolate(corners, truth.part()), false};
    }
  }
  return best;
}

void compare(const Fields& fields, double right, const Felt& truth, const Felt& play,
             Figures& figures) {
  figures.snaps += play.snapped;
  if (!(distance(truth.force, {0, 0, 0}) > kContact)) return;
  const double off = distance(truth.force, play.force);
  figures.force_error.push_back(off);
  ++figures.ticks;
  figures.close += off <= kClose;
  figures.right += rms(fields, truth.row, play.row) <= right;
}

/// The first way there, after which the rule is on some branch, and the two that follow. The first
/// ways of a path do not count: in their first ticks a late answer has not come yet.
void compare_ways(const Fields& fields, double right, const std::vector<Felt>& truth,
                  const std::vector<Felt>& play, Figures& figures) {
  for (std::size_t i = 3 * kLeg; i + 3 * kLeg <= play.size(); i += 3 * kLeg) {
    bool is_smooth = true, is_apart = false;
    for (std::size_t j = 0; j < kLeg && is_smooth; ++j) {
      const std::size_t back = i + 2 * kLeg - 1 - j, again = i + 2 * kLeg + j;
      is_smooth = !play[i + j].snapped && !play[back].snapped && !play[again].snapped &&
                  rms(fields, truth[i + j].row, truth[back].row) <= right / 3 &&
                  rms(fields, truth[back].row, truth[again].row) <= right / 3 &&
                  distance(truth[i + j].force, truth[back].force) <= kClose / 3 &&
                  distance(truth[back].force, truth[again].force) <= kClose / 3;
      is_apart |= distance(play[back].force, play[again].force) > kClose ||
                  distance(play[i + j].force, play[back].force) > kClose;
    }
    if (!is_smooth) continue;
    ++figures.ways;
    figures.ways_apart += is_apart;
  }
}

int run(const Grid& grid, int argc, char** argv) {
  const MakeModel make = model_of(grid, argv[2]);
  const std::string kind = argv[3];
  const double right = std::atof(argv[4]);
  const auto number = [&](int i, std::uint64_t otherwise) {
    return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
  };
  const std::uint64_t count = number(5, 20), seed = number(6, 1), speed = number(7, 20);
  const Played played(grid, make);
  const std::optional<Grid> other = argc > 10 ? std::optional(load_grid(argv[10])) : std::nullopt;
  const Grid& of = other ? *other : grid;
  const Paths paths(of, other ? record_fields(of, make, 1).force : played.records.force, kind,
                    static_cast<double>(speed), number(9, 4000));
  ModelTraversal truth(grid, make());
  const auto by_branch = [&] { return std::make_unique<BranchTraversal>(grid, played.map); };
  std::vector<std::unique_ptr<Rule>> rules;
  const auto add = [&](const char* name, std::unique_ptr<Traversal> traversal) {
    rules.push_back(std::make_unique<Rule>(name, grid, played, std::move(traversal)));
  };
  add("paper", std::make_unique<PaperTraversal>(grid));
  add("branch", by_branch());
  add("beside", by_branch());
  rules.back()->walk_beside(make, 1);
  add("late", by_branch());
  rules.back()->walk_beside(make, static_cast<std::uint32_t>(number(8, 5)));
  Figures of_oracle;
  for (std::uint64_t p = 0; p < count; ++p) {
    const std::vector<Vec3> path = paths.make(seed + p);
    std::vector<Felt> model, best;
    for (std::size_t i = 0; right > 0 && i < path.size(); ++i) {
      if (!go(truth, path, i).usable()) throw Error("the model fails on this path");
      const std::span<const double> row = truth.row();
      model.push_back(
          {{row.begin(), row.end()}, played.fields.force(truth.position(), row), false});
      best.push_back(oracle(grid, played, truth));
      compare(played.fields, right, model.back(), best.back(), of_oracle);
    }
    for (const auto& rule : rules) {
      rule->begin_path();
      if (right == 0) rule->time(path);
      for (std::size_t i = 0; i < model.size(); ++i) {
        rule->follow(path, i);
        compare(played.fields, right, model[i], rule->felt[i], rule->figures);
      }
      if (kind == "back") compare_ways(played.fields, right, model, rule->felt, rule->figures);
    }
    if (kind == "back") compare_ways(played.fields, right, model, best, of_oracle);
  }
  for (const auto& rule : rules) rule->figures.print(kind, rule->name());
  of_oracle.print(kind, "oracle");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::main_of(
      argc, argv, 5,
      "bench_branches GRID MODELS KIND RIGHT [PATHS] [SEED] [SPEED] [DELAY] [TICKS] [OF]", run);
}
