#include "libcore/follow/record_fields.hpp"

#include <algorithm>
#include <cmath>
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

void Agreement::add(double force_here, double force_low, double force_high, double energy_low,
                    double energy_high, double h) {
  const auto square = [](double x) { return x * x; };
  const double sum = force_low + force_high;
  const double slope = (energy_high - energy_low) / (2 * h);
  ++predictions;
  force += square(force_here);
  by_forces += square(force_here - sum / 2);
  by_energy += square(force_here - (-1.5 * slope - sum / 4));
}

void Agreement::finish() {
  for (double* sum : {&force, &by_energy, &by_forces})
    *sum = std::sqrt(*sum / static_cast<double>(std::max<std::uint64_t>(1, predictions)));
}

Agreement agreement(const Grid& grid, const RecordFields& fields) {
  Agreement found;
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int a = 0; a < 3; ++a) {
      const Direction up = Direction::up(a);
      const RecordIndex high = grid.two_way(r, up.q()), low = grid.two_way(r, up.opposite().q());
      if (high == Grid::kNoRecord || low == Grid::kNoRecord) continue;
      found.add(fields.force[r][a], fields.force[low][a], fields.force[high][a], fields.energy[low],
                fields.energy[high], grid.box().spacing);
    }
  found.finish();
  return found;
}

}  // namespace hapgrid
