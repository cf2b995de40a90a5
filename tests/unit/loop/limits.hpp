// Limits of a safety core of which a test switches on what it needs.
#pragma once

#include <limits>

#include "libcore/loop/safety.hpp"

namespace hapgrid::testing {

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kEps = std::numeric_limits<double>::epsilon();
inline constexpr Vec3 kZero{0, 0, 0};

/// Every stage off but the clamp, and the tank where the place is known.
inline SafetyLimits only_clamp(double max_force) {
  return {.max_force = max_force,
          .slew = kInf,
          .ramp_ms = 0,
          .max_speed = kInf,
          .buzz_force = kInf,
          .fade_cells = 0,
          .watchdog_ticks = kInf};
}

/// Every stage off but slew, clamp and tank.
inline SafetyLimits only_tank() {
  SafetyLimits limits = only_clamp(3);
  limits.slew = 1;
  return limits;
}

/// A tick in which a spring along x holds its energy, with a hand at x. @param rest of a wall: x
/// beyond which it is free
inline SafetyInput on_spring(double stiffness, double x, double rest = kInf) {
  const double deep = x > rest ? 0 : x;
  const double energy = stiffness / 2 * deep * deep;
  return {.force = {-stiffness * deep, 0, 0},
          .place = Vec3{x, 0, 0},
          .model_energy = energy,
          .account = energy};
}

}  // namespace hapgrid::testing
