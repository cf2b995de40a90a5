// How points, records, links and states are named in messages.
#pragma once

#include <span>
#include <string>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// "point 17 (2, 1, 0)"
std::string describe(const Box& box, PointIndex point);
/// "point 17 (2, 1, 0) level 1"
std::string describe(const Box& box, PointIndex point, Level level);
std::string describe(const Grid& grid, RecordIndex r);
/// "point 5 (1, 2, 0) level 1 direction 3 (-1, 0, -1)"
std::string describe_link(const Grid& grid, RecordIndex r, int q);

/// A state for people: "0.1", or "(0.1, 0.2, 0.3, ...)" with at most four components.
std::string state_text(std::span<const double> state);

}  // namespace hapgrid
