// What a step of Algorithm 2 costs, for states of 9 numbers. The HIP follows one smooth path
// through the box, sampled so that it spends a given number of ticks in a cell. At 1 kHz, with a
// workspace of 150 mm as the box and a hand at 0.1 m/s, that is 50 ticks a cell with 30 points a
// side and 12 with 128.
//
// The column s/step counts: 18n is 18 ns of CPU time a step.
//
// The worst tick: states of 1,521 numbers (507 atoms), and a HIP that jumps from end to end of a
// long box in each tick, so that each step takes all 64 sub-steps. `worst` and `p99` are seconds of
// CPU time of single steps; `substeps` is how many the median step took.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "libcore/base/histogram.hpp"
#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/paper_traversal.hpp"
#include "tests/bench/smooth_path.hpp"
#include "tests/unit/haptic/random_grid.hpp"

namespace {

using namespace hapgrid;

constexpr std::uint32_t kStateSize = 9;

/// Arguments: points a side, ticks a cell.
void step(benchmark::State& state) {
  const auto side = static_cast<std::uint32_t>(state.range(0));
  const double spacing = 2.0 / (side - 1);
  const Box box{{-1, -1, -1}, spacing, {side, side, side}};
  // Half of the points have two levels, and links are random: branch prediction works worse than in
  // a real grid.
  const Grid grid = testing::random_grid(box, kStateSize, 2, 1);
  const auto path = bench::smooth_path(spacing / static_cast<double>(state.range(1)), 1 << 20);
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

std::int64_t cpu_ns() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec * 1'000'000'000 + t.tv_nsec;
}

/// Arguments: numbers in a state, whether the traversal stays on its branch.
void worst_tick(benchmark::State& state) {
  const Box box{{0, 0, 0}, 1, {80, 6, 6}};
  const Grid grid = testing::random_grid(box, static_cast<std::uint32_t>(state.range(0)), 2, 1);
  const BranchMap map(grid);
  BranchTraversal branch(grid, std::make_shared<const BranchMap>(grid));
  PaperTraversal paper(grid);
  Traversal& traversal = state.range(1) ? static_cast<Traversal&>(branch) : paper;
  traversal.start({0.5, 0.5, 0.5});
  Histogram times, switches;
  std::uint64_t lagging = 0;
  std::size_t i = 0;
  for (auto _ : state) {
    // 79 cells in x, and an eighth of that much across: faces, edges, vertices.
    const Vec3 hip{++i % 2 ? 78.5 : 0.5, 0.3 + 0.37 * static_cast<double>(i % 13),
                   0.3 + 0.37 * static_cast<double>(i / 13 % 13)};
    const std::int64_t before = cpu_ns();
    const StepResult r = traversal.step(hip);
    times.add(cpu_ns() - before);
    switches.add(r.face_switches + r.edge_switches + r.vertex_switches);
    lagging += r.lagging;
  }
  state.counters["worst"] = static_cast<double>(times.max()) * 1e-9;
  state.counters["p99"] = static_cast<double>(times.quantile(0.99)) * 1e-9;
  state.counters["substeps"] = static_cast<double>(switches.quantile(0.5));
  state.counters["lagging"] = static_cast<double>(lagging) / static_cast<double>(i);
}

BENCHMARK(worst_tick)
    ->ArgNames({"n", "branch"})
    ->ArgsProduct({{9, 1521}, {0, 1}})
    ->Iterations(5000);

}  // namespace

BENCHMARK_MAIN();
