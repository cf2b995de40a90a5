// A declared tolerance function (Sect. 2.3): a norm of the difference of two states. It is written
// into a shard, so that a reader of the shard can compare states without the model.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
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

  /// States are compared too often to ask a model process; such a model always declares a norm.
  bool is_declared() const { return norm != Norm::kPlugin; }
  /// Whether the weights suit states of n components, and are finite and not negative.
  bool fits(std::uint32_t n) const {
    return (weights.empty() || weights.size() == n) &&
           std::all_of(weights.begin(), weights.end(),
                       [](double w) { return std::isfinite(w) && w >= 0; });
  }
  friend bool operator==(const Equality&, const Equality&) = default;
};

/// Whether the states a and b (n components) are equal. Not for Norm::kPlugin. Real-time safe.
/// States whose difference is not a number are different.
inline bool are_equal(const Equality& equality, double tolerance, std::uint32_t n, const double* a,
                      const double* b) {
  const double* w = equality.weights.empty() ? nullptr : equality.weights.data();
  if (equality.norm == Equality::Norm::kMax) {
    for (std::uint32_t c = 0; c < n; ++c)
      if (!(std::abs(a[c] - b[c]) * (w ? w[c] : 1) <= tolerance)) return false;
    return true;
  }
  double sum = 0;
  for (std::uint32_t c = 0; c < n; ++c) {
    const double difference = (a[c] - b[c]) * (w ? w[c] : 1);
    sum += difference * difference;
  }
  return std::sqrt(sum / n) <= tolerance;
}

/// The distance of two states in the norm that `equality` names, and that the tolerance bounds. For
/// Norm::kPlugin the largest difference of a component. NaN when a component is not a number.
inline double distance(const Equality& equality, std::uint32_t n, const double* a,
                       const double* b) {
  const double* w = equality.weights.empty() ? nullptr : equality.weights.data();
  double largest = 0, sum = 0;
  for (std::uint32_t c = 0; c < n; ++c) {
    const double difference = std::abs(a[c] - b[c]) * (w ? w[c] : 1);
    if (difference > largest || std::isnan(difference)) largest = difference;
    sum += difference * difference;
  }
  return equality.norm == Equality::Norm::kRms ? std::sqrt(sum / n) : largest;
}

}  // namespace hapgrid
