// What a step of Algorithm 2 costs, for states of 9 numbers. The HIP follows one smooth path
// through the box, sampled so that it spends a given number of ticks in a cell. At 1 kHz, with a
// workspace of 150 mm as the box and a hand at 0.1 m/s, that is 50 ticks a cell with 30 points a
// side and 12 with 128.
//
// The column s/step counts: 18n is 18 ns of CPU time a step.
#include "libcore/haptic/paper_traversal.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/haptic/random_grid.hpp"

namespace {

using namespace hapgrid;

constexpr std::uint32_t kStateSize = 9;

/// A Lissajous figure that stays inside [-1, 1]^3, with steps of about the length `step`.
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
  // Half of the points have two levels, and links are random: branch prediction works worse than in
  // a real grid.
  const Grid grid = testing::random_grid(box, kStateSize, 2, 1);
  const auto path = smooth_path(spacing / static_cast<double>(state.range(1)), 1 << 20);
  PaperTraversal traversal(grid);
  traversal.start(path[0]);
  std::uint64_t switches = 0, steps = 0;
  for (auto _ : state) {  // an iteration is the whole path: a step is too short to be timed
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
