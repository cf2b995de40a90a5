// A step of Algorithm 2, n = 9, in nanoseconds: on one smooth path through the box, sampled so that
// the HIP spends so many ticks in a cell of each grid. At 1 kHz, with a workspace of 150 mm as the
// box and a hand at 0.1 m/s, that is 50 ticks a cell at 30 points a side and 12 at 128.
//
// Read s/step: 18n is 18 ns of CPU time a step. Built with libbenchmark and the sources of
// libcore/haptic/traversal.cpp and libcore/grid, as the release preset builds them.
#include "libcore/haptic/traversal.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/haptic/random_grid.hpp"

namespace {

using namespace hapgrid;

constexpr std::uint32_t kStateSize = 9;

/// A Lissajous figure that stays inside [-1, 1]^3, with steps of the length `step`, give or take.
std::vector<Vec3> smooth_path(double step, std::size_t count) {
  std::vector<Vec3> path(count);
  double t = 0;
  for (Vec3& x : path) {
    x = {0.97 * std::sin(t), 0.97 * std::sin(1.618 * t + 0.5), 0.97 * std::sin(2.414 * t + 1)};
    const double speed = std::hypot(0.97 * std::cos(t), 1.57 * std::cos(1.618 * t + 0.5),
                                    2.34 * std::cos(2.414 * t + 1));
    t += step / std::max(speed, 0.3);
  }
  return path;
}

/// Arguments: points a side, ticks a cell.
void step(benchmark::State& state) {
  const auto side = static_cast<std::uint32_t>(state.range(0));
  const double spacing = 2.0 / (side - 1);
  const Box box{{-1, -1, -1}, spacing, {side, side, side}};
  // Two levels at half of the points, links at random: worse than a real grid for the predictor.
  const Grid grid = testing::random_grid(box, kStateSize, 2, 1);
  const auto path = smooth_path(spacing / static_cast<double>(state.range(1)), 1 << 20);
  Traversal traversal(grid);
  traversal.start(path[0]);
  std::uint64_t switches = 0, steps = 0;
  for (auto _ : state) {  // an iteration is the whole path: a step is not longer than its stopwatch
    for (const Vec3& x : path) {
      const StepResult r = traversal.step(x);
      switches += r.face_switches + r.edge_switches + r.vertex_switches;
    }
    steps += path.size();
    benchmark::DoNotOptimize(traversal.state().data());
  }
  state.counters["s/step"] = benchmark::Counter(
      static_cast<double>(steps), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["switches/step"] = static_cast<double>(switches) / static_cast<double>(steps);
}

BENCHMARK(step)
    ->ArgNames({"side", "ticks_a_cell"})
    ->Args({30, 50})
    ->Args({30, 12})
    ->Args({128, 50})
    ->Args({128, 12})
    ->Args({128, 4});

}  // namespace

BENCHMARK_MAIN();
