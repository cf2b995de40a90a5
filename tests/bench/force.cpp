// How far the forces that play can send are off the model's, and what a tick of each costs.
//
//   bench_force GRID MODELS [TICKS] [SEED]
//
// MODELS is the directory of the plug-ins. A hand moves at random, 25 ticks a spacing, by the rule
// of branches; the model itself is asked 32 times a spacing along the same way. Only ticks are
// counted in which the model pushes the hand.
//
// A line for each force and kind of cell: energy, records or state; whole cells, or torn ones, in
// which the branch ends; ticks that count; the error in newtons, its median and 99th percentile;
// nanoseconds a tick of the force alone, over all ticks.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/check/random_hand.hpp"
#include "libcore/haptic/agreement.hpp"
#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/model_traversal.hpp"
#include "libcore/haptic/node_force.hpp"
#include "libcore/haptic/record_fields.hpp"
#include "libcore/model/plugin_model.hpp"
#include "libcore/shard/load.hpp"

namespace {

using namespace hapgrid;

constexpr double kContact = 1e-6;  // newtons

double distance(const Vec3& a, const Vec3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Force {
  const char* name;
  std::function<Vec3(const Traversal&)> at;
  std::vector<double> errors[2] = {};  // whole cells, torn ones
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
    if (i == 0)
      traversal.start(path[i]);
    else
      traversal.step(path[i]);
    if (force) sum += force->at(traversal)[0];
  }
  const std::chrono::duration<double, std::nano> passed = std::chrono::steady_clock::now() - begin;
  if (std::isnan(sum)) throw Error("a force is not a number");
  return passed.count() / static_cast<double>(path.size());
}

void measure(const Grid& grid, const std::vector<Vec3>& path, const MakeModel& make,
             const std::shared_ptr<const BranchMap>& map, std::vector<Force>& forces) {
  const Fields fields(grid.spec(), make, false);
  ModelTraversal truth(grid, make());
  BranchTraversal branch(grid, map);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool good = i == 0 ? truth.start(path[i]).usable() : truth.step(path[i]).usable();
    if (!good) throw Error("the model fails on this path");
    if (i == 0)
      branch.start(path[i]);
    else
      branch.step(path[i]);
    const Vec3 model = fields.force(truth.position(), truth.row());
    const auto& nodes = branch.nodes();
    const bool torn = std::any_of(nodes.begin(), nodes.end(),
                                  [&](Node node) { return map->nodes.is_ghost(node); });
    for (Force& force : forces) {
      const double error = distance(force.at(branch), model);
      if (distance(model, {0, 0, 0}) > kContact) force.errors[torn].push_back(error);
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

int run(int argc, char** argv) {
  const LoadedGrid loaded = load_grid(argv[1]);
  const Grid& grid = loaded.grid;
  const MakeModel make = [&] {
    return Plugin(grid.spec().model, {argv[2]}).create(grid.spec().parameters);
  };
  const std::size_t ticks = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 200'000;
  const std::uint64_t seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  const auto map = std::make_shared<const BranchMap>(grid);
  const RecordFields at_records = record_fields(grid, make, 2);
  const auto energies = std::make_shared<const NodeEnergies>(grid, &map->nodes, at_records);
  const Fields fields(grid.spec(), make, false);
  std::vector<Force> forces;
  forces.push_back({"energy", NodeForce(energies, grid.box(), hermite_force)});
  forces.push_back({"records", NodeForce(energies, grid.box(), mean_force)});
  forces.push_back(
      {"state", [&](const Traversal& t) { return fields.force(t.position(), t.row()); }});
  measure(grid, places(grid.box(), seed, ticks), make, map, forces);
  const Agreement a = agreement(grid, at_records);
  std::printf(
      "# records %u, ghosts %u; errors of predicted forces, N: %.4g by energy, %.4g by forces\n",
      grid.records(), map->nodes.ghosts(), a.by_energy, a.by_forces);
  for (Force& force : forces)
    for (int torn = 0; torn < 2; ++torn)
      std::printf("%s\t%s\t%zu\t%.5f\t%.4f\t%.1f\n", force.name, torn ? "torn" : "whole",
                  force.errors[torn].size(), quantile(force.errors[torn], 0.5),
                  quantile(force.errors[torn], 0.99), force.nanoseconds);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "bench_force GRID MODELS [TICKS] [SEED]\n");
    return 2;
  }
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_force: %s\n", e.what());
    return 1;
  }
}
