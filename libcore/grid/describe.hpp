// The names of points and records in messages.
#pragma once

#include <string>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// "point 17 (2, 1, 0)"
std::string describe(const Box& box, PointIndex point);
/// "point 17 (2, 1, 0) level 1"
std::string describe(const Box& box, PointIndex point, Level level);

}  // namespace hapgrid
