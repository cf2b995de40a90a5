// A tolerance function (Sect. 2.3) that stands in words, so that whoever reads a shard can judge
// equality without the model: a norm of the difference of two states, component by component.
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
  std::vector<double> weights;  ///< w: n entries, or none where all are 1

  /// A model that is a process cannot be asked as often as this is, so it always says it in words.
  bool is_declared() const { return norm != Norm::kPlugin; }
  /// Whether the weights can be those of states of n components: finite and not negative.
  bool fits(std::uint32_t n) const {
    return (weights.empty() || weights.size() == n) &&
           std::all_of(weights.begin(), weights.end(),
                       [](double w) { return std::isfinite(w) && w >= 0; });
  }
  friend bool operator==(const Equality&, const Equality&) = default;
};

/// Whether states a and b (n components) count as the same. Not for Norm::kPlugin. Real-time safe.
/// Written so that a difference that is not a number makes them different.
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

/// How far apart two states are in the norm that `equality` names, which its tolerance bounds; for
/// Norm::kPlugin in the largest difference of a component. Not a number where a state is not.
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
