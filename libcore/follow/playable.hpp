// Checks that a grid can be played.
#pragma once

#include <string>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// Refuses a grid that cannot be played as a whole, and says what to do about it.
/// @param name of the grid, for messages.
/// @throw Error when the frontier has records, a point has no level, a link inside the box leads
/// nowhere, or a state is not finite.
void require_playable(const Grid& grid, const std::string& name);

}  // namespace hapgrid
