#include "libcore/follow/agreement.hpp"

#include <algorithm>
#include <cmath>

namespace hapgrid {

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
