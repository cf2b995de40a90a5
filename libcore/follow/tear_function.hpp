// Where each branch of a grid ends: a function of place for each branch, which is positive where
// the branch is, and negative beyond the place where the model snaps off it.
//
// It is given at the nodes of the branches (branch_nodes.hpp) and interpolated in a cell like
// everything else. A tear fraction says where it has to be 0: one equation for each one-way link,
// in the numbers of the corners of the cell that the link crosses. The start is the distance from
// the plane that fits the tear fractions around a node best; then the equations of all links are
// solved together, in the sense of least squares.
#pragma once

#include <vector>

#include "libcore/follow/branch_nodes.hpp"

namespace hapgrid {

/// @returns by node, the records first: in spacings, positive at records and negative at ghosts; 2
/// at records around which nothing tears. A grid without tear fractions tears in the middle of its
/// one-way links.
std::vector<float> tear_function(const Grid& grid, const BranchNodes& branches);

/// Where on the one-way link in direction q of record r the model snaps, in (0, 1).
inline double tear_fraction(const Grid& grid, RecordIndex r, int q) {
  const TearByte tear = grid.has_tears() ? grid.tears(r)[q] : kNoTear;
  return tear == kNoTear ? 0.5 : tear_fraction(tear);
}

}  // namespace hapgrid
