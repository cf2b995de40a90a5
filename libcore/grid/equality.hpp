// How states are compared and blended: which components are angles or orientations, and a declared
// tolerance function (Sect. 2.3), which is a norm of the difference of two states. It is written
// into a shard, so that a reader of the shard can compare states without the model.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace hapgrid {

struct Equality {
  enum class Norm : std::uint8_t {
    kPlugin,  ///< the plug-in's own function decides
    kMax,     ///< max_c  w_c |a_c - b_c| <= tolerance
    kRms,     ///< sqrt((1/n) sum_c (w_c (a_c - b_c))^2) <= tolerance
  };
  Norm norm = Norm::kPlugin;
  std::vector<double> weights;  ///< w: n entries, or none when all are 1
  /// What the components are: n entries, or none when all are plain numbers. 0 is a plain number. A
  /// positive entry is the period of an angle: a and a + period are the same. Six entries kRotation
  /// in a row are the first two columns of a rotation matrix, which are orthonormal.
  std::vector<double> periods;

  /// States are compared too often to ask a model process; such a model always declares a norm.
  bool is_declared() const { return norm != Norm::kPlugin; }
  static constexpr double kRotation = -1;

  /// Whether the weights suit states of n components, and are finite and not negative, and the
  /// periods are as described.
  bool fits(std::uint32_t n) const {
    return (weights.empty() || weights.size() == n) &&
           std::all_of(weights.begin(), weights.end(),
                       [](double w) { return std::isfinite(w) && w >= 0; }) &&
           fits_periods(n);
  }
  bool fits_periods(std::uint32_t n) const {
    if (!periods.empty() && periods.size() != n) return false;
    for (std::size_t c = 0; c < periods.size(); ++c) {
      if (!std::isfinite(periods[c]) || (periods[c] < 0 && periods[c] != kRotation)) return false;
      if (periods[c] != kRotation) continue;
      for (int k = 0; k < 6; ++k, ++c)
        if (c >= periods.size() || periods[c] != kRotation) return false;
      --c;
    }
    return true;
  }
  bool has_angles() const { return !periods.empty(); }
  bool is_rotation(std::size_t c) const { return c < periods.size() && periods[c] == kRotation; }
  friend bool operator==(const Equality&, const Equality&) = default;
};

/// The value of component c that is the same as `value` and lies nearest to `reference`: for an
/// angle some periods are added. Real-time safe.
inline double nearest(const Equality& equality, std::size_t c, double value, double reference) {
  if (c >= equality.periods.size() || !(equality.periods[c] > 0)) return value;
  const double period = equality.periods[c];
  return value - period * std::round((value - reference) / period);
}

/// The angle in radians between two orientations, each two columns of a rotation matrix.
double angle_between(const double* a, const double* b);

/// Makes the two columns orthonormal: the first keeps its direction. Columns of which that cannot
/// be made become the first two axes.
void orthonormalise(double* columns);

/// Makes each orientation of a row orthonormal. Real-time safe.
void orthonormalise_rotations(const Equality& equality, std::span<double> row) noexcept;

/// After `row` became the sum of w[k] rows[k], component by component: angles are blended on the
/// shorter way around. Real-time safe.
void blend_angles(const Equality& equality, const std::array<double, 8>& w,
                  const std::array<const double*, 8>& rows, std::span<double> row) noexcept;

/// Writes the weighted difference of each component of the states a and b to use(difference).
/// Angles count with the shorter way around, and the six numbers of an orientation as one, the
/// angle between both in radians, with the weight of its first.
template <class Use>
void differences(const Equality& equality, std::uint32_t n, const double* a, const double* b,
                 Use&& use) {
  const double* w = equality.weights.empty() ? nullptr : equality.weights.data();
  for (std::uint32_t c = 0; c < n; ++c) {
    const double weight = w ? w[c] : 1;
    if (equality.is_rotation(c)) {
      use(angle_between(a + c, b + c) * weight);
      c += 5;
    } else {
      use(std::abs(nearest(equality, c, a[c], b[c]) - b[c]) * weight);
    }
  }
}

/// Whether the states a and b (n components) are equal. Not for Norm::kPlugin. Real-time safe.
/// States whose difference is not a number are different.
inline bool are_equal(const Equality& equality, double tolerance, std::uint32_t n, const double* a,
                      const double* b) {
  if (equality.norm == Equality::Norm::kMax) {
    bool equal = true;
    differences(equality, n, a, b, [&](double d) { equal &= d <= tolerance; });
    return equal;
  }
  double sum = 0;
  differences(equality, n, a, b, [&](double d) { sum += d * d; });
  return std::sqrt(sum / n) <= tolerance;
}

/// The distance of two states in the norm that `equality` names, and that the tolerance bounds. For
/// Norm::kPlugin the largest difference of a component. NaN when a component is not a number.
inline double distance(const Equality& equality, std::uint32_t n, const double* a,
                       const double* b) {
  double largest = 0, sum = 0;
  differences(equality, n, a, b, [&](double d) {
    if (d > largest || std::isnan(d)) largest = d;
    sum += d * d;
  });
  return equality.norm == Equality::Norm::kRms ? std::sqrt(sum / n) : largest;
}

}  // namespace hapgrid
