// What play can be in when it stays on its branch (haptic/branch_traversal.hpp).
#pragma once

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/haptic/sheets.hpp"

namespace hapgrid {

/// `branches`: in every cell around every record, the branch of this record has a node in all
/// corners. The state is then continuous but for snaps by construction, whatever the links are.
/// Counts the cells around all records. Figures: how many of them a branch ends in (`torn`), how
/// many are `mixed` (Sheets::is_mixed()), and how many `ghosts` there are.
/// @param threads at least 1; the result does not depend on it.
Check check_branches(const Grid& grid, const Sheets& sheets, int threads);

}  // namespace hapgrid
