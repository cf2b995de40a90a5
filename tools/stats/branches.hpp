// The branches of a grid, for pictures: the records that a hand reaches without a snap.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// Records that two-way links connect, at most one at each point, so that a branch is a field. From
/// the smallest record that is in no branch yet, a branch takes in neighbour after neighbour, the
/// nearest first, unless it has a record at that point already: where two sheets are connected
/// around a fold, one of them is cut off and becomes a later branch. So branches are in the order
/// of their smallest records.
struct Branches {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  std::vector<std::uint32_t> of_record;
  std::vector<RecordIndex> sizes;  ///< by branch

  /// The record of a branch at a point; Grid::kNoRecord if it has none there.
  RecordIndex record(const Grid& grid, std::uint32_t branch, PointIndex point) const;
};

Branches find_branches(const Grid& grid);

/// A line about one branch: how many there are, how large it is, and which are the largest.
std::string branch_text(const Branches& branches, std::uint32_t branch);

}  // namespace hapgrid
