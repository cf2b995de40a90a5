// How a grid grew: for each generation the conversions of its records, the chunks of the grid that
// they change. Fed to simulate.py.
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "libcore/grid/box.hpp"
#include "libcore/shard/reader.hpp"

int main(int argc, char** argv) {
  using namespace hapgrid;
  if (argc != 2) return std::fputs("usage: bench_growth GRID\n", stderr), 2;
  const Section grid = open_grid(argv[1]);
  const GridSpec& spec = grid.header.spec;
  const Neighbourhood neighbourhood(spec.box);
  const std::uint64_t chunk = chunk_points(spec.row_size());
  const std::uint64_t chunks = (spec.box.points() + chunk - 1) / chunk;
  // By generation: the conversions, and whether a source or a target lies in a chunk.
  std::vector<std::uint64_t> conversions;
  std::vector<std::vector<bool>> changed;
  SectionReader reader(grid);
  RecordRows rows;
  for (std::size_t i = 0; i < grid.footer.chunks.size(); ++i) {
    reader.read(i, rows);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const std::uint32_t generation = rows.generation[r];
      const PointIndex point = rows.point[r];
      while (conversions.size() <= generation) {
        conversions.push_back(0);
        changed.emplace_back(chunks);
      }
      changed[generation][point / chunk] = true;
      for (DirectionMask left = neighbourhood.inside(point); left; left &= left - 1) {
        const auto target =
            static_cast<std::uint64_t>(point + neighbourhood.offset(std::countr_zero(left)));
        ++conversions[generation];
        changed[generation][target / chunk] = true;
      }
    }
  }
  for (std::size_t g = 0; g < conversions.size(); ++g)
    std::printf("%zu %llu %lld\n", g, static_cast<unsigned long long>(conversions[g]),
                static_cast<long long>(std::count(changed[g].begin(), changed[g].end(), true)));
}
