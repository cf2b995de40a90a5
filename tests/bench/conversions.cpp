// The cost of C itself: evaluates the conversions that Algorithm 1 evaluates for a grid, with the
// same arguments and in the same order, and nothing else. Prints CPU nanoseconds a conversion.
#include <cstdio>
#include <ctime>
#include <vector>

#include "libcore/model/plugin_model.hpp"
#include "libcore/shard/reader.hpp"

int main(int argc, char** argv) {
  using namespace hapgrid;
  if (argc != 2) return std::fputs("usage: bench_conversions GRID\n", stderr), 2;
  const Grid grid = load_grid(argv[1]);
  const auto model = Plugin(grid.spec().model, model_path()).create(grid.spec().parameters);
  std::vector<double> reached(grid.state_size());
  std::size_t conversions = 0;
  double sum = 0;
  timespec begin{};
  timespec end{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const Vec3 x = grid.box().position(grid.point(r));
    const DirectionMask inside = grid.neighbourhood().inside(grid.point(r));
    for (int q = 0; q < kDirections; ++q) {
      if (!(inside >> q & 1)) continue;
      if (!model->convert(grid.state(r).data(), x, grid.neighbourhood().shift(q), reached.data()))
        return std::fputs("a conversion failed\n", stderr), 1;
      sum += reached[0];
      ++conversions;
    }
  }
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
  const double ns = 1e9 * static_cast<double>(end.tv_sec - begin.tv_sec) +
                    static_cast<double>(end.tv_nsec - begin.tv_nsec);
  // The sum keeps the compiler from leaving the work out.
  std::fprintf(stderr, "sum of the states reached: %.17g\n", sum);
  std::printf("%.2f\n", ns / static_cast<double>(conversions));
}
