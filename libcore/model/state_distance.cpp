#include "libcore/model/state_distance.hpp"

#include <algorithm>
#include <vector>

namespace hapgrid {

double state_distance(const Model& model, std::span<const double> a, std::span<const double> b) {
  constexpr double kLeast = 0x1p-60, kMost = 0x1p40;
  const Equality& equality = model.info().equality;
  const double tolerance = model.info().tolerance;
  const std::uint32_t n = model.state_size();
  if (equality.is_declared() || !(tolerance > 0)) return distance(equality, n, a.data(), b.data());
  if (std::equal(a.begin(), a.begin() + n, b.begin())) return 0;
  std::vector<double> between(n);
  const auto same_at = [&](double part) {
    for (std::size_t c = 0; c < n; ++c)
      between[c] = a[c] + part * (nearest(equality, c, b[c], a[c]) - a[c]);
    orthonormalise_rotations(equality, between);
    return model.equal(a.data(), between.data());
  };
  double least = 1;  // a λ with which the states are the same
  while (!same_at(least) && least > kLeast) least /= 2;
  double most = 2 * least;  // and one with which they are not
  while (same_at(most) && most < kMost) most *= 2;
  least = most / 2;
  while (most - least > 1e-6 * least) {
    const double middle = (least + most) / 2;
    (same_at(middle) ? least : most) = middle;
  }
  return tolerance / least;
}

}  // namespace hapgrid
