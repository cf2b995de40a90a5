// Numbers that many tests of the haptic loop need.
#pragma once

#include <limits>

#include "libcore/grid/vec3.hpp"

namespace hapgrid::testing {

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kEps = std::numeric_limits<double>::epsilon();
inline constexpr Vec3 kZero{0, 0, 0};

}  // namespace hapgrid::testing
