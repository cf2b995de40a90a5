// How far the forces that play can send are off the model's, and what a tick of each costs.
//
//   bench_force GRID MODELS [TICKS] [SEED]
//
// MODELS is the directory of the plug-ins. A hand moves at random, 25 ticks a spacing, by the rule
// of branches; the model itself is asked 32 times a spacing along the same way. Only ticks are
// counted in which the model pushes the hand.
//
// A line for each force, energy and state: its error in newtons, the median and the 99th
// percentile, and nanoseconds a tick of the force alone, over all ticks.
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>

#include "libcore/base/error.hpp"
#include "libcore/check/walk.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/model_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/follow/record_fields.hpp"
#include "tests/bench/bench.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

constexpr double kContact = 1e-6;  // newtons

struct Force {
  const char* name;
  std::function<Vec3(const Traversal&)> at;
  std::vector<double> errors = {};
  double nanoseconds = 0;
};

std::vector<Vec3> places(const Box& box, std::uint64_t seed, std::size_t ticks) {
  RandomHand hand(box, seed, 25);
  std::vector<Vec3> path;
  hand.put(box.position(hand.jump()));
  while (path.size() < ticks) {
    hand.set_out();
    for (int i = 0; i < 25; ++i) {
      hand.step();
      path.push_back(hand.at());
    }
  }
  return path;
}

/// The cost of a force is that of the way with it less that of the way without it.
double time(Traversal& traversal, const std::vector<Vec3>& path, const Force* force) {
  const auto begin = std::chrono::steady_clock::now();
  double sum = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    go(traversal, path, i);
    if (force) sum += force->at(traversal)[0];
  }
  const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - begin;
  if (std::isnan(sum)) throw Error("a force is not a number");
  return passed.count() / static_cast<double>(path.size());
}

void measure(const Grid& grid, const std::vector<Vec3>& path, const MakeModel& make,
             const std::shared_ptr<const BranchNodes>& map, std::vector<Force>& forces) {
  const Fields fields(grid.spec(), make, false);
  ModelTraversal truth(grid, make());
  BranchTraversal branch(grid, map);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!go(truth, path, i).usable()) throw Error("the model fails on this path");
    go(branch, path, i);
    const Vec3 model = fields.force(truth.position(), truth.row());
    for (Force& force : forces) {
      const double error = distance(force.at(branch), model);
      if (distance(model, {0, 0, 0}) > kContact) force.errors.push_back(error);
    }
  }
  BranchTraversal again(grid, map);
  double best_without = 1e300;
  for (int turn = 0; turn < 5; ++turn)
    best_without = std::min(best_without, time(again, path, nullptr));
  for (Force& force : forces) {
    double best = 1e300;
    for (int turn = 0; turn < 5; ++turn) best = std::min(best, time(again, path, &force));
    force.nanoseconds = best - best_without;
  }
}

int run(const Grid& grid, int argc, char** argv) {
  const MakeModel make = model_of(grid, argv[2]);
  const std::size_t ticks = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 200'000;
  const std::uint64_t seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  const auto map = std::make_shared<const BranchNodes>(grid);
  const RecordFields at_records = record_fields(grid, make, 2);
  const auto energies =
      std::make_shared<const NodeEnergies>(node_energies(grid, at_records, map.get()));
  const Fields fields(grid.spec(), make, false);
  std::vector<Force> forces;
  forces.push_back({"energy", NodeForce(energies, grid.box(), hermite_force)});
  forces.push_back(
      {"state", [&](const Traversal& t) { return fields.force(t.position(), t.row()); }});
  measure(grid, places(grid.box(), seed, ticks), make, map, forces);
  for (Force& force : forces)
    std::printf("%s\t%.5f\t%.4f\t%.1f\n", force.name, quantile(force.errors, 0.5),
                quantile(force.errors, 0.99), force.nanoseconds);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::main_of(argc, argv, 3, "bench_force GRID MODELS [TICKS] [SEED]", run);
}
