// Cells in which play by the paper's rule can mix branches.
#pragma once

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `blends`, a note and no fault: the cells in which the eight records that play takes from one
/// corner's destination levels are not linked with each other. Near a tear-off they belong to
/// different branches, and the interpolated state is one that the model never takes.
/// A cell is looked at with its lowest point. Source: design.md, section 7.6.
/// @param threads at least 1; the result does not depend on it.
Check check_blends(const Grid& grid, int threads);

}  // namespace hapgrid
