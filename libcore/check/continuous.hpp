// Whether the state jumps while the hand moves.
#pragma once

#include "libcore/check/report.hpp"
#include "libcore/follow/branch_nodes.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `continuous`: in every cell around every record, the branch of this record has a node in all
/// corners. The rule that stays on a branch (follow/branch_traversal.hpp) then always has a state
/// to go on with, and this state jumps nowhere but at a snap. Counts the cells around all records.
/// Figures: in how many of them a branch ends (`torn`), how many are `mixed`
/// (BranchNodes::is_mixed()), and how many `ghosts` there are.
Check check_continuous(const Grid& grid, const BranchNodes& branches);

}  // namespace hapgrid
