// How a grid grew: for each generation the conversions of its records. Fed to simulate.py.
#include <bit>
#include <cstdio>
#include <vector>

#include "libcore/grid/box.hpp"
#include "libcore/shard/reader.hpp"

int main(int argc, char** argv) {
  using namespace hapgrid;
  if (argc != 2) return std::fputs("usage: bench_growth GRID\n", stderr), 2;
  const Section grid = open_grid(argv[1]);
  const Neighbourhood neighbourhood(grid.header.spec.box);
  std::vector<unsigned long long> conversions(grid.header.generation + 1);
  SectionReader reader(grid);
  RecordRows rows;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) {
    reader.read(i, rows);
    for (std::size_t r = 0; r < rows.size(); ++r)
      conversions[rows.generation[r]] +=
          static_cast<unsigned>(std::popcount(neighbourhood.inside(rows.point[r])));
  }
  for (std::size_t g = 0; g < conversions.size(); ++g)
    std::printf("%zu\t%llu\n", g, conversions[g]);
}
