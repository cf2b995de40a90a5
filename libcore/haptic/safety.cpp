#include "libcore/haptic/safety.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "libcore/base/error.hpp"

namespace hapgrid {

namespace {

bool finite(const Vec3& f) {
  return std::isfinite(f[0]) && std::isfinite(f[1]) && std::isfinite(f[2]);
}

/// Scales f to the magnitude `limit` when it is larger; answers whether it was.
bool clamp_magnitude(Vec3& f, double limit) {
  // Through the largest component, since the square of a finite force can be infinite or zero.
  const double largest = std::max({std::abs(f[0]), std::abs(f[1]), std::abs(f[2])});
  if (largest == 0) return false;
  const Vec3 unit{f[0] / largest, f[1] / largest, f[2] / largest};
  const double length = std::sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
  if (largest <= limit / length) return false;
  // The few roundings here and in whoever checks the magnitude must not end above the limit.
  const double scale = limit / length * (1 - 8 * std::numeric_limits<double>::epsilon());
  for (int a = 0; a < 3; ++a) f[a] = unit[a] * scale;
  return true;
}

}  // namespace

SafetyCore::SafetyCore(const SafetyLimits& limits) : limits_(limits) {
  if (!std::isfinite(limits.max_force) || limits.max_force < 0)
    throw Error("safety: the force limit is " + std::to_string(limits.max_force) +
                " N, it must be finite and not negative");
}

SafeForce SafetyCore::apply(const Vec3& raw) noexcept {
  SafeForce safe;
  if (!finite(raw)) faulted_ = true;
  safe.faulted = faulted_;
  if (faulted_) return safe;
  safe.force = raw;
  safe.clamped = clamp_magnitude(safe.force, limits_.max_force);
  return safe;
}

}  // namespace hapgrid
