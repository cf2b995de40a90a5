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

/// A tick in which a spring along x holds its energy, with a hand at x. @param rest of a wall: x
/// beyond which it is free
inline SafetyInput on_spring(double stiffness, double x,
                             double rest = std::numeric_limits<double>::infinity()) {
  const double deep = x > rest ? 0 : x;
  const double energy = stiffness / 2 * deep * deep;
  return {.force = {-stiffness * deep, 0, 0},
          .place = Vec3{x, 0, 0},
          .model_energy = energy,
          .account = energy};
}

}  // namespace hapgrid::testing
