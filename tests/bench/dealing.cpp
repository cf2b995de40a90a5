// How alike the parts of a round are: measures every conversion of one generation, CPU time, and
// adds up those of each part, dealt out in turns as `expand --part` does, and for comparison cut
// into stretches of the frontier.
//
//   bench_dealing alanine.grid 8 GENERATION...
//
// The grid is a finished one: its records of a generation were the frontier of that round.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <vector>

#include "libcore/model/plugin_model.hpp"
#include "libcore/search/frontier.hpp"
#include "libcore/shard/load.hpp"

namespace {

using namespace hapgrid;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Seconds of each conversion, in the order of the frontier.
std::vector<double> measure(const Grid& grid, Model& model, std::uint32_t generation) {
  std::vector<double> seconds;
  std::vector<double> reached(grid.spec().row_size());
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (grid.record_generation(r) != generation) continue;
    const Vec3 x = grid.box().position(grid.point(r));
    const DirectionMask inside = grid.neighbourhood().inside(grid.point(r));
    for (int q = 0; q < kDirections; ++q) {
      if (!(inside >> q & 1)) continue;
      const double start = cpu_seconds();
      if (!model.convert(grid.state(r).data(), x, grid.neighbourhood().shift(q), reached.data()))
        std::fputs("bench_dealing: a conversion failed\n", stderr), std::exit(1);
      seconds.push_back(cpu_seconds() - start);
    }
  }
  return seconds;
}

void print(const char* how, const std::vector<double>& parts) {
  double mean = 0;
  for (const double part : parts) mean += part / static_cast<double>(parts.size());
  const auto [least, most] = std::minmax_element(parts.begin(), parts.end());
  std::printf("  %-12s parts take %+.1f %% to %+.1f %% of their mean of %.2f s\n", how,
              100 * (*least / mean - 1), 100 * (*most / mean - 1), mean);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return std::fputs("usage: bench_dealing GRID PARTS GENERATION...\n", stderr), 2;
  const LoadedGrid loaded = load_grid(argv[1]);
  const std::size_t parts = std::strtoul(argv[2], nullptr, 10);
  const std::unique_ptr<Model> model =
      Plugin(loaded.grid.spec().model, model_path({})).create(loaded.grid.spec().parameters);
  for (int i = 3; i < argc; ++i) {
    const auto generation = static_cast<std::uint32_t>(std::strtoul(argv[i], nullptr, 10));
    const std::vector<double> seconds = measure(loaded.grid, *model, generation);
    std::printf("generation %u: %zu conversions\n", generation, seconds.size());
    std::vector<double> dealt(parts), stretches(parts);
    for (std::size_t k = 0; k < parts; ++k) {
      const Partition part(seconds.size(), {k + 1, parts});
      for (std::size_t c = 0; c < seconds.size(); ++c)
        if (part.mine(1, c)) dealt[k] += seconds[c];
    }
    for (std::size_t c = 0; c < seconds.size(); ++c)
      stretches[c * parts / seconds.size()] += seconds[c];
    print("in turns", dealt);
    print("in stretches", stretches);
  }
}
