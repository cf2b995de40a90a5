// Proves over all configurations (configurations.hpp) that play never gets stuck and never jumps,
// whatever the hand does; and counts what is worth knowing about them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/check/configurations.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// "cell (1, 2, 0) with levels 0 1 0 0 0 1 0 0"
std::string describe(const Grid& grid, const Configuration& configuration);

/// Four rows.
///
/// `paths`: no start and no switch needs a link that is missing. Counts configurations.
///
/// `continuous`: each switch keeps the record of each vertex that the two cells have in common.
/// Then the state is continuous across the face, edge or vertex between them: there the other
/// corners of either cell have the weight 0, and the common ones have the same weights in both
/// (traversal.hpp). Counts switches.
///
/// `mixed`, a note: configurations of which one corner has a link to another level of another
/// corner's point than the configuration has there (design.md, section 7.6). The gap is how far
/// those two states of one point are apart, in the norm of the tolerance function: the interpolated
/// state is off the model's by less than that.
///
/// `one-way`, a note: configurations with a switch that cannot be taken back: the way back leads to
/// other levels (hysteresis).
///
/// Links that wait for an expand are left to `complete`, points without a level to `coverage`.
/// @param threads at least 1; the result does not depend on it.
std::vector<Check> check_paths(const Grid& grid, const CellMap& map, const Configurations& found,
                               int threads);

}  // namespace hapgrid
