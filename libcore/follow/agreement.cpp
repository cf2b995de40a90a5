#include "libcore/follow/agreement.hpp"

#include <algorithm>
#include <cmath>

namespace hapgrid {

Agreement agreement(const Grid& grid, const RecordFields& fields) {
  Agreement found;
  const double h = grid.box().spacing;
  const auto square = [](double x) { return x * x; };
  for (RecordIndex r = 0; r < grid.records(); ++r)
    for (int a = 0; a < 3; ++a) {
      const Direction up = Direction::up(a);
      const RecordIndex high = grid.two_way(r, up.q()), low = grid.two_way(r, up.opposite().q());
      if (high == Grid::kNoRecord || low == Grid::kNoRecord) continue;
      const double force = fields.force[r][a];
      const double sum = fields.force[low][a] + fields.force[high][a];
      const double slope = (fields.energy[high] - fields.energy[low]) / (2 * h);
      ++found.predictions;
      found.force += square(force);
      found.by_forces += square(force - sum / 2);
      found.by_energy += square(force - (-1.5 * slope - sum / 4));
    }
  for (double* sum : {&found.force, &found.by_energy, &found.by_forces})
    *sum = std::sqrt(*sum / static_cast<double>(std::max<std::uint64_t>(1, found.predictions)));
  return found;
}

}  // namespace hapgrid
