#include "libcore/check/branches.hpp"

#include <cstdint>
#include <string>
#include <utility>

#include "libcore/base/parallel.hpp"
#include "libcore/grid/cell.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

struct BranchesSeen {
  Findings cells;
  std::uint64_t torn = 0, mixed = 0;

  void add(BranchesSeen&& later) {
    cells.add(std::move(later.cells));
    torn += later.torn;
    mixed += later.mixed;
  }
};

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

void look_around(const Grid& grid, const Sheets& sheets, RecordIndex r, int corner,
                 BranchesSeen& seen) {
  ++seen.cells.counted;
  bool is_torn = false;
  for (int k = 0; k < 8; ++k) {
    const int q = kBetweenCorners[corner][k];
    bool is_flat = false;
    for (int a = 0; a < 3; ++a) is_flat |= grid.box().counts[a] == 1 && (k >> a & 1) != 0;
    if (q < 0 || is_flat) continue;
    const Node node = sheets.node(r, q);
    if (node == Sheets::kNoNode)
      return seen.cells.offend(place_of(grid, r, q),
                               [&] { return describe_link(grid, r, q) + ": leads to no record"; });
    is_torn |= sheets.is_ghost(node);
  }
  seen.torn += is_torn;
  seen.mixed += sheets.is_mixed(r, corner);
}

}  // namespace

Check check_branches(const Grid& grid, const Sheets& sheets, int threads) {
  constexpr std::uint64_t kBlock = 1 << 12;
  BranchesSeen seen = sum_of_blocks<BranchesSeen>(
      grid.records(), kBlock, threads, [&](std::uint64_t begin, std::uint64_t end) {
        BranchesSeen part;
        for (auto r = static_cast<RecordIndex>(begin); r < end; ++r)
          for (int corner = 0; corner < 8; ++corner)
            if (!grid.in_frontier(r) && has_cell(grid.box(), grid.point(r), corner))
              look_around(grid, sheets, r, corner, part);
        return part;
      });
  Check check{"branches", "cells", "cells around a record in which its branch lacks a corner",
              std::move(seen.cells)};
  check.figures = {
      {"torn", static_cast<double>(seen.torn), "", "of these cells: the branch ends in them"},
      {"mixed", static_cast<double>(seen.mixed), "",
       "of these cells: two other corners are not of one branch themselves"},
      {"ghosts", static_cast<double>(sheets.ghosts()), "",
       "extrapolated rows at points before which a branch ends"}};
  return check;
}

}  // namespace hapgrid
