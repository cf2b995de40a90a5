// How a grid grew: for each generation the conversions of its records, the chunks of the grid that
// they change, and how unevenly they fall into ranges. Fed to simulate.py.
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "libcore/grid/box.hpp"
#include "libcore/shard/format.hpp"
#include "libcore/shard/merged_rows.hpp"
#include "libcore/shard/section.hpp"

int main(int argc, char** argv) {
  using namespace hapgrid;
  if (argc != 3) return std::fputs("usage: bench_growth GRID RANGES\n", stderr), 2;
  const std::vector<Section> sections = open_sections({argv[1]});
  const GridSpec& spec = sections.front().header.spec;
  const Neighbourhood neighbourhood(spec.box);
  const std::uint64_t chunk = chunk_points(spec.row_size());
  const std::uint64_t chunks = (spec.box.points() + chunk - 1) / chunk;
  // Requests to each chunk, and whether a source lies in it, by generation.
  std::vector<std::vector<std::uint64_t>> requests;
  std::vector<std::vector<bool>> changed;
  MergedRows<RecordRows> records(sections);
  for (Run<RecordRows> run = records.next(); run.rows; run = records.next())
    for (std::size_t r = run.begin; r < run.end; ++r) {
      const std::uint32_t generation = run.rows->generation[r];
      const PointIndex point = run.rows->point[r];
      while (requests.size() <= generation) {
        requests.emplace_back(chunks);
        changed.emplace_back(chunks);
      }
      changed[generation][point / chunk] = true;
      for (DirectionMask left = neighbourhood.inside(point); left; left &= left - 1) {
        const auto target =
            static_cast<std::uint64_t>(point + neighbourhood.offset(std::countr_zero(left)));
        ++requests[generation][target / chunk];
        changed[generation][target / chunk] = true;
      }
    }
  const std::uint64_t ranges = std::min<std::uint64_t>(std::strtoul(argv[2], nullptr, 10), chunks);
  for (std::size_t g = 0; g < requests.size(); ++g) {
    std::uint64_t all = 0;
    std::uint64_t busiest = 0;
    for (std::uint64_t range = 0, c = 0; range < ranges; ++range) {
      std::uint64_t sum = 0;
      for (; c < (range + 1) * chunks / ranges; ++c) sum += requests[g][c];
      busiest = std::max(busiest, sum);
      all += sum;
    }
    std::printf("%zu %llu %lld %llu\n", g, static_cast<unsigned long long>(all),
                static_cast<long long>(std::count(changed[g].begin(), changed[g].end(), true)),
                static_cast<unsigned long long>(busiest));
  }
}
