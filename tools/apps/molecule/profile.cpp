#include "tools/apps/molecule/profile.hpp"

#include <algorithm>
#include <cstddef>

namespace hapgrid::molecule {

Profile::Profile(const std::vector<double>& energies, std::size_t start)
    : first_(static_cast<double>(start)), last_(energies.back()) {
  const std::size_t n = energies.size();
  std::vector<double> slope(n);  // per node distance
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = energies[i] - energies[i - 1], after = energies[i + 1] - energies[i];
    if (before * after > 0) slope[i] = 2 * before * after / (before + after);
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double rise = energies[i + 1] - energies[i];
    segments_.push_back({{energies[i], slope[i], 3 * rise - 2 * slope[i] - slope[i + 1],
                          slope[i] + slope[i + 1] - 2 * rise}});
  }
}

Profile::Value Profile::at(double t) const {
  const double count = static_cast<double>(segments_.size());
  const double at = std::max(0.0, t * count + first_);
  const std::size_t segment = std::min(static_cast<std::size_t>(at), segments_.size() - 1);
  const double u = at - static_cast<double>(segment);
  const double* a = segments_[segment].a;
  // The coefficients' rounding must not show in the transition state's energy.
  const double energy = u == 1 ? last_ : a[0] + u * (a[1] + u * (a[2] + u * a[3]));
  return {energy, count * (a[1] + u * (2 * a[2] + u * 3 * a[3])),
          count * count * (2 * a[2] + u * 6 * a[3])};
}

}  // namespace hapgrid::molecule
