// How long each of a grid's conversions takes: a line a record, its conversions in microseconds of
// CPU time, in the order in which the search has them. Stretches of records that follow each other
// are taken evenly from the whole search, since neighbours are alike. What simulate.py is fed with:
//
//   bench_conversion_times alanine.grid 16 24 > tests/bench/scaling/times.tsv
//
// the alanine dipeptide of examples/molecule, 20 points a side in the same box, spacing 0.809 Å.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <vector>

#include "libcore/model/plugin_model.hpp"
#include "libcore/shard/load.hpp"

namespace {

double cpu_ns() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace hapgrid;
  if (argc != 4)
    return std::fputs("usage: bench_conversion_times GRID STRETCHES RECORDS\n", stderr), 2;
  const std::size_t stretches = std::strtoul(argv[2], nullptr, 10);
  const std::size_t length = std::strtoul(argv[3], nullptr, 10);

  const LoadedGrid loaded = load_grid(argv[1]);
  const Grid& grid = loaded.grid;
  std::vector<RecordIndex> order(grid.records());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&grid](RecordIndex a, RecordIndex b) {
    return grid.record_generation(a) < grid.record_generation(b);
  });
  if (stretches < 2 || order.size() < length)
    return std::fputs("bench_conversion_times: two stretches or more, within the grid\n", stderr),
           2;
  const auto model = Plugin(grid.spec().model, model_path({})).create(grid.spec().parameters);
  std::vector<double> reached(grid.spec().row_size());
  for (std::size_t i = 0; i < stretches; ++i) {
    const std::size_t begin = i * (order.size() - length) / (stretches - 1);
    for (std::size_t k = begin; k < begin + length; ++k) {
      const double* state = grid.state(order[k]).data();
      const PointIndex point = grid.point(order[k]);
      const Vec3 x = grid.box().position(point);
      const DirectionMask inside = grid.neighbourhood().inside(point);
      const char* separator = "";
      for (int q = 0; q < kDirections; ++q) {
        if (!(inside >> q & 1)) continue;
        // Once for the caches, as behind the conversions before it, then in earnest.
        double took = 0;
        for (int twice = 0; twice < 2; ++twice) {
          const double start = cpu_ns();
          if (!model->convert(state, x, grid.neighbourhood().shift(q), reached.data()))
            return std::fputs("a conversion failed\n", stderr), 1;
          took = cpu_ns() - start;
        }
        std::printf("%s%.0f", separator, took / 1e3);
        separator = " ";
      }
      std::putchar('\n');
    }
  }
}
