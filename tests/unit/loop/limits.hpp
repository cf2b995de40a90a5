// Limits of a safety core of which a test switches on what it needs.
#pragma once

#include <limits>

#include "libcore/loop/safety.hpp"

namespace hapgrid::testing {

/// Every stage off but the clamp, and the tank where the place is known.
inline SafetyLimits only_clamp(double max_force) {
  constexpr double kOff = std::numeric_limits<double>::infinity();
  return {.max_force = max_force,
          .slew = kOff,
          .ramp_ms = 0,
          .max_speed = kOff,
          .buzz_force = kOff,
          .fade_cells = 0,
          .watchdog_ticks = kOff};
}

/// Every stage off but slew, clamp and tank.
inline SafetyLimits only_tank() {
  SafetyLimits limits = only_clamp(3);
  limits.slew = 1;
  return limits;
}

}  // namespace hapgrid::testing
