#include "libcore/check/continuous.hpp"

#include <cstdint>

#include "libcore/grid/cell.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

/// Whether the box has the cell in which a point is corner `corner`. Of a flat cell the lower
/// corner of two counts.
bool has_cell(const Box& box, PointIndex point, int corner) {
  const GridCoordinates c = box.coordinates(point);
  for (int a = 0; a < 3; ++a) {
    const bool is_upper = corner >> a & 1;
    if (box.counts[a] == 1 ? is_upper : is_upper ? c[a] == 0 : c[a] + 1 == box.counts[a])
      return false;
  }
  return true;
}

/// Finds whether the branch of record r has a node in all corners of the cell in which r is corner
/// `corner`. Counts the cell in `torn` where a node is a ghost.
void check_cell(const Grid& grid, const BranchNodes& branches, const Cells& cells, RecordIndex r,
                int corner, Findings& found, std::uint64_t& torn) {
  ++found.counted;
  bool is_torn = false;
  for (int k = 0; k < 8; ++k) {
    const int q = kBetweenCorners[corner][k];
    if (q < 0 || !cells.is_corner(k)) continue;
    const Node node = branches.node(r, q);
    if (node == BranchNodes::kNoNode)
      return found.offend(location_of(grid, r, q),
                          [&] { return describe_link(grid, r, q) + ": leads to no record"; });
    is_torn |= branches.is_ghost(node);
  }
  torn += is_torn;
}

}  // namespace

Check check_continuous(const Grid& grid, const BranchNodes& branches) {
  Check check{
      "continuous", "cells", "cells around a record in which its branch lacks a corner", {}};
  const Cells cells(grid);
  std::uint64_t torn = 0, mixed = 0;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (grid.in_frontier(r)) continue;
    for (int corner = 0; corner < 8; ++corner) {
      if (!has_cell(grid.box(), grid.point(r), corner)) continue;
      check_cell(grid, branches, cells, r, corner, check.found, torn);
      mixed += branches.is_mixed(r, corner);
    }
  }
  check.figures = {
      {"torn", static_cast<double>(torn), "", "of these cells: the branch ends in them"},
      {"mixed", static_cast<double>(mixed), "",
       "of these cells: two other corners are not of one branch themselves"},
      {"ghosts", static_cast<double>(branches.ghosts()), "",
       "extrapolated rows at points before which a branch ends"}};
  return check;
}

}  // namespace hapgrid
