// How often a rule of traversal is on the branch that the model is on, how far its force is off,
// and what a step costs.
//
//   bench_branches GRID MODELS KIND RIGHT [PATHS] [SEED] [TICKS]
//
// MODELS is the directory of the plug-ins. KIND is what the paths are like:
//   smooth    sums of sines through the inner nine tenths of the box
//   straight  there and back along the x axis, in lines of a random place
//   diagonal  there and back between two random places
//   tear-off  from a point with one level along a branch to a place where it ends, and 40 times to
//   and
//             fro within two spacings of it
// Each path is followed by both rules, with TICKS ticks a spacing (25), and by the model itself,
// asked 32 times a spacing. A tick is right when the spheres that show the state are within RIGHT
// (root mean square, the model's unit of length) of the model's. Only ticks are counted in which
// the model pushes the hand. With RIGHT 0 the model is not asked: that leaves the cost.
//
// A line for each rule: kind, rule, ticks that count, % of them right, the force's error in newtons
// (median, 99th percentile), snaps, nanoseconds a step.
#include <chrono>
#include <cstdlib>
#include <deque>
#include <map>
#include <memory>
#include <numbers>

#include "libcore/base/error.hpp"
#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/model_traversal.hpp"
#include "libcore/haptic/paper_traversal.hpp"
#include "libcore/haptic/tear_function.hpp"
#include "libcore/model/fields.hpp"
#include "tests/bench/bench.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

constexpr std::size_t kTicks = 4000;  // of a path
constexpr double kContact = 1e-6;     // newtons

class Paths {
 public:
  Paths(const Grid& grid, std::string kind, double ticks_a_cell)
      : grid_(grid), box_(grid.box()), kind_(std::move(kind)), ticks_a_cell_(ticks_a_cell) {
    if (kind_ != "tear-off") return;
    for (RecordIndex r = 0; r < grid.records(); ++r)
      for (int q = 0; q < kDirections; ++q)
        if (grid.is_one_way(r, q)) tears_.push_back({r, q});
    if (tears_.empty()) throw Error("this grid has no one-way link");
  }

  std::vector<Vec3> make(std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    if (kind_ == "smooth") return smooth(random);
    if (kind_ == "tear-off") return to_a_tear(random);
    Vec3 from = place(random), to = place(random);
    if (kind_ == "straight") {
      to = from;
      from[0] = box_.origin[0];
      to[0] = box_.origin[0] + box_.spacing * (box_.counts[0] - 1);
    }
    std::vector<Vec3> path;
    while (path.size() < kTicks) {
      go(path, from, to);
      go(path, to, from);
    }
    return path;
  }

 private:
  Vec3 place(std::mt19937_64& random) const {
    Vec3 x;
    for (int a = 0; a < 3; ++a)
      x[a] = box_.origin[a] + box_.spacing * (box_.counts[a] - 1) * uniform(random, 0.05, 0.95);
    return x;
  }

  void go(std::vector<Vec3>& path, const Vec3& from, const Vec3& to) const {
    const double way = distance(to, from);
    const double ticks = std::ceil(way / box_.spacing * ticks_a_cell_);
    for (double i = 0; i < ticks; ++i) {
      Vec3 x;
      for (int a = 0; a < 3; ++a) x[a] = from[a] + i / ticks * (to[a] - from[a]);
      path.push_back(x);
    }
  }

  std::vector<Vec3> smooth(std::mt19937_64& random) const {
    constexpr int kSines = 3;
    double phase[3][kSines], rate[3][kSines];
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < kSines; ++i) {
        phase[a][i] = uniform(random, 0, 2 * std::numbers::pi);
        rate[a][i] = uniform(random, 0.5, 1 + i);
      }
    const auto at = [&](double t) {
      Vec3 x;
      for (int a = 0; a < 3; ++a) {
        double s = 0;
        for (int i = 0; i < kSines; ++i) s += std::sin(rate[a][i] * t + phase[a][i]) / kSines;
        x[a] = box_.origin[a] +
               box_.spacing * (box_.counts[a] - 1) * (0.5 + 0.45 * std::clamp(1.5 * s, -1.0, 1.0));
      }
      return x;
    };
    std::vector<Vec3> path;
    double t = 0;
    while (path.size() < kTicks) {
      path.push_back(at(t));
      const Vec3 now = at(t), soon = at(t + 1e-4);
      const double speed = distance(soon, now) / 1e-4;
      t += std::min(0.05, box_.spacing / ticks_a_cell_ / std::max(speed, 1e-9));
    }
    return path;
  }

  /// The way along two-way links from a point with one level to a record, or nothing.
  std::vector<RecordIndex> way_to(RecordIndex record) const {
    std::map<RecordIndex, RecordIndex> before{{record, record}};
    std::deque<RecordIndex> queue{record};
    while (!queue.empty()) {
      RecordIndex r = queue.front();
      queue.pop_front();
      if (grid_.levels(grid_.point(r)) == 1) {
        std::vector<RecordIndex> way{r};
        while (r != record) way.push_back(r = before[r]);
        return way;
      }
      for (int q = 0; q < kDirections; ++q) {
        const RecordIndex to = grid_.destination(r, q);
        if (to != Grid::kNoRecord && !grid_.is_one_way(r, q) && before.try_emplace(to, r).second)
          queue.push_back(to);
      }
    }
    return {};
  }

  std::vector<Vec3> to_a_tear(std::mt19937_64& random) const {
    std::vector<Vec3> path;
    std::vector<RecordIndex> way;
    Tear tear{};
    while (way.empty()) {
      tear = tears_[random() % tears_.size()];
      way = way_to(tear.from);
    }
    Vec3 at = box_.position(grid_.point(way.front()));
    for (const RecordIndex r : way) {
      const Vec3 to = box_.position(grid_.point(r));
      go(path, at, to);
      at = to;
    }
    const double t = tear_fraction(grid_, tear.from, tear.q);
    const Vec3 from = at;
    for (int leg = 0; leg < 40; ++leg) {
      Vec3 to;
      for (int a = 0; a < 3; ++a) {
        to[a] = from[a] + t * grid_.neighbourhood().shift(tear.q)[a] +
                box_.spacing * uniform(random, -2, 2);
        to[a] =
            std::clamp(to[a], box_.origin[a], box_.origin[a] + box_.spacing * (box_.counts[a] - 1));
      }
      go(path, at, to);
      at = to;
    }
    return path;
  }

  struct Tear {
    RecordIndex from;
    int q;
  };
  const Grid& grid_;
  const Box& box_;
  std::string kind_;
  double ticks_a_cell_;
  std::vector<Tear> tears_;
};

struct Figures {
  std::uint64_t ticks = 0, right = 0, snaps = 0, steps = 0;
  double nanoseconds = 0;
  std::vector<double> force_error;

  void print(const char* kind, const char* rule) {
    std::printf(
        "%s\t%s\t%llu\t%.2f\t%.4f\t%.3f\t%llu\t%.1f\n", kind, rule,
        static_cast<unsigned long long>(ticks),
        100.0 * static_cast<double>(right) / static_cast<double>(std::max(ticks, std::uint64_t{1})),
        quantile(force_error, 0.5), quantile(force_error, 0.99),
        static_cast<unsigned long long>(snaps), nanoseconds / static_cast<double>(steps));
  }
};

class Comparison {
 public:
  Comparison(const Grid& grid, const MakeModel& make, double right)
      : fields_(grid.spec(), make, true), right_(right), spheres_(fields_.spheres().size()) {}

  void add(const Traversal& truth, const Traversal& play, Figures& figures) {
    const Vec3 f = fields_.force(truth.position(), truth.row());
    if (!(distance(f, {0, 0, 0}) > kContact)) return;
    const Vec3 g = fields_.force(play.position(), play.row());
    figures.force_error.push_back(distance(f, g));
    ++figures.ticks;
    figures.right += rms(truth.row(), play.row()) <= right_;
  }

 private:
  double rms(std::span<const double> a, std::span<const double> b) const {
    std::vector<float> p(3 * spheres_), q(3 * spheres_);
    fields_.shape(a, p);
    fields_.shape(b, q);
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += (p[i] - q[i]) * (p[i] - q[i]);
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, spheres_)));
  }

  Fields fields_;
  double right_;
  std::size_t spheres_;
};

/// The whole path by one rule, timed.
void time(Traversal& play, const std::vector<Vec3>& path, Figures& figures) {
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < path.size(); ++i) figures.snaps += go(play, path, i).snapped;
  const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - begin;
  figures.nanoseconds += passed.count();
  figures.steps += path.size();
}

int run(const Grid& grid, int argc, char** argv) {
  const MakeModel make = model_of(grid, argv[2]);
  const double right = std::atof(argv[4]);
  const int count = argc > 5 ? std::atoi(argv[5]) : 20;
  const std::uint64_t seed = argc > 6 ? std::strtoull(argv[6], nullptr, 10) : 1;
  const Paths paths(grid, argv[3], argc > 7 ? std::atof(argv[7]) : 25);
  ModelTraversal truth(grid, make());
  PaperTraversal paper(grid);
  BranchTraversal branch(grid, std::make_shared<const BranchMap>(grid));
  Comparison comparison(grid, make, right);
  Figures of_paper, of_branch;
  for (int i = 0; i < count; ++i) {
    const std::vector<Vec3> path = paths.make(seed + static_cast<std::uint64_t>(i));
    time(paper, path, of_paper);
    time(branch, path, of_branch);
    for (std::size_t tick = 0; right > 0 && tick < path.size(); ++tick) {
      if (!go(truth, path, tick).usable()) throw Error("the model fails on this path");
      go(paper, path, tick);
      go(branch, path, tick);
      comparison.add(truth, paper, of_paper);
      comparison.add(truth, branch, of_branch);
    }
  }
  of_paper.print(argv[3], "paper");
  of_branch.print(argv[3], "branch");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::main_of(argc, argv, 5,
                        "bench_branches GRID MODELS KIND RIGHT [PATHS] [SEED] [TICKS]", run);
}
