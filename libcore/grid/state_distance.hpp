// How far two states are apart, in the unit of the tolerance.
//
// A declared tolerance function is a norm (grid/equality.hpp), which has a value. A plug-in only
// says whether two states are the same: a molecule's compares atoms, for example. We search for the
// largest λ such that the plug-in still calls a and a + λ (b - a) the same. Then the distance is
// tolerance / λ. For a norm this is exact; otherwise it is a good approximation near the tolerance.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// The tolerance function of Sect. 2.3 on two states of n doubles.
using SameState = std::function<bool(const double* a, const double* b)>;

/// For one thread.
class StateDistance {
 public:
  /// @param spec outlives this. @param same the model's tolerance function
  StateDistance(const GridSpec& spec, SameState same)
      : spec_(spec), same_(std::move(same)), between_(spec.state_size) {}

  bool is_same(std::span<const double> a, std::span<const double> b) const {
    return same_(a.data(), b.data());
  }

  /// Of finite states, or rows that begin with them. To one part in a million. Of a plug-in that
  /// forgives nothing (tolerance 0): the largest difference of a component.
  double operator()(std::span<const double> a, std::span<const double> b) {
    const std::uint32_t n = spec_.state_size;
    if (spec_.equality.is_declared() || !(spec_.tolerance > 0))
      return distance(spec_.equality, n, a.data(), b.data());
    if (std::equal(a.begin(), a.begin() + n, b.begin())) return 0;
    double least = 1;  // a λ with which the states are the same
    while (!same_at(a, b, least) && least > kLeast) least /= 2;
    double most = 2 * least;  // and one with which they are not
    while (same_at(a, b, most) && most < kMost) most *= 2;
    least = most / 2;
    while (most - least > 1e-6 * least) {
      const double middle = (least + most) / 2;
      (same_at(a, b, middle) ? least : most) = middle;
    }
    return spec_.tolerance / least;
  }

 private:
  static constexpr double kLeast = 0x1p-60;
  static constexpr double kMost = 0x1p40;

  bool same_at(std::span<const double> a, std::span<const double> b, double part) {
    for (std::size_t c = 0; c < between_.size(); ++c)
      between_[c] = a[c] + part * (nearest(spec_.equality, c, b[c], a[c]) - a[c]);
    orthonormalise_rotations(spec_.equality, between_);
    return same_(a.data(), between_.data());
  }

  const GridSpec& spec_;
  SameState same_;
  std::vector<double> between_;
};

}  // namespace hapgrid
