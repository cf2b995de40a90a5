#include "libcore/follow/record_fields.hpp"

#include <deque>

#include "libcore/base/parallel.hpp"

namespace hapgrid {

RecordFields record_fields(const Grid& grid, const MakeModel& create, int threads) {
  std::deque<Fields> fields;  // one for each thread
  for (int t = 0; t < threads; ++t) fields.emplace_back(grid.spec(), create, /*wants_shape=*/false);
  const double scale = fields.front().force_scale();
  const bool has_energy = fields.front().has_energy() && scale > 0;
  RecordFields found;
  found.force.resize(grid.records());
  if (has_energy) found.energy.resize(grid.records());
  constexpr std::size_t kBlock = 4096;
  for_each_with_own((std::size_t{grid.records()} + kBlock - 1) / kBlock, fields,
                    [&](const Fields& mine, std::size_t block) {
                      const std::size_t end =
                          std::min<std::size_t>(grid.records(), (block + 1) * kBlock);
                      for (auto r = static_cast<RecordIndex>(block * kBlock); r < end; ++r) {
                        const Vec3 x = grid.box().position(grid.point(r));
                        found.force[r] = mine.force(x, grid.row(r));
                        if (has_energy) found.energy[r] = scale * mine.energy(x, grid.row(r));
                      }
                    });
  return found;
}

}  // namespace hapgrid
