// The nodes of each branch: what a branch has at the points of a cell, also where it ends.
//
// Records that two-way links connect are one branch. Where a link is one-way, the model snaps on
// the way: the branch of its record ends before the point to which the link leads. There it gets a
// *ghost*: the row that it would have at that point if it did not end, extrapolated along the
// branch. So a branch has a row in all corners of a cell in which it ends, and it can be
// interpolated up to the place where the model snaps (branch_traversal.hpp says where that is).
//
// One point can have ghosts of several branches. Two records beside it belong to the same one when
// two-way links connect them, directly or by other records that end before this point.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/grid/cell.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// A record (below Grid::records()), or a ghost.
using Node = std::uint32_t;

class BranchNodes {
 public:
  static constexpr Node kNoNode = Grid::kNoRecord;

  /// The branch of its record ends before the point to which it leads.
  struct OneWayLink {
    PointIndex point;  // to which it leads
    RecordIndex from;
    std::uint8_t q;
  };

  /// @param grid outlives this. Its links are not trusted.
  explicit BranchNodes(const Grid& grid);

  bool is_ghost(Node node) const { return node >= grid_.records(); }
  Node ghosts() const { return static_cast<Node>(ghost_first_.size() - 1); }
  /// Where the branch of record r is at its neighbour in direction q; kNoNode where there is no
  /// link. Real-time safe, as all that follow.
  Node node(RecordIndex r, int q) const noexcept {
    return one_way_[r] >> q & 1 ? ghost_of_[link_number(r, q)] : grid_.destination(r, q);
  }
  /// The same where the neighbour is known to be corner `corner` of the cell at `base`.
  Node node(RecordIndex r, int q, const Cells& cells, PointIndex base, int corner) const noexcept {
    return one_way_[r] >> q & 1 ? ghost_of_[link_number(r, q)]
                                : cells.destination(r, q, base, corner);
  }
  /// The directions in which the branch of record r ends before the neighbour.
  DirectionMask one_way(RecordIndex r) const noexcept { return one_way_[r]; }
  /// Whether no branch ends, and none meets another one, in any cell of the grid.
  bool are_whole() const noexcept {
    return ghosts() == 0 &&
           std::all_of(mixed_.begin(), mixed_.end(), [](std::uint8_t cells) { return cells == 0; });
  }
  /// Whether no branch ends in the cells around record r, and none of them is mixed.
  bool has_one_branch_around(RecordIndex r) const noexcept { return has_one_branch_[r]; }
  /// Whether the cell in which record r is corner `corner` is mixed: two other records of the
  /// branch in this cell are not of one branch themselves.
  bool is_mixed(RecordIndex r, int corner) const noexcept { return mixed_[r] >> corner & 1; }
  /// Which corners of a cell have records that are not of one branch: bit b of entry a, a < b.
  /// Corners that are ghosts or kNoNode belong to any branch.
  std::array<std::uint8_t, 8> apart(const std::array<Node, 8>& corners) const noexcept;
  /// The one-way links for which a ghost stands, ascending by record.
  std::span<const OneWayLink> links_into_ghost(Node node) const noexcept {
    const std::size_t ghost = node - grid_.records();
    return std::span(ghost_links_)
        .subspan(ghost_first_[ghost], ghost_first_[ghost + 1] - ghost_first_[ghost]);
  }
  const double* row(Node node) const noexcept {
    return is_ghost(node) ? &ghost_rows_[std::size_t{node - grid_.records()} * row_size_]
                          : grid_.row(node).data();
  }
  PointIndex point(Node node) const noexcept {
    return is_ghost(node) ? links_into_ghost(node).front().point : grid_.point(node);
  }

 private:
  /// The number of the one-way link in direction q of record r.
  std::uint32_t link_number(RecordIndex r, int q) const noexcept {
    const DirectionMask before = one_way_[r] & ((DirectionMask{1} << q) - 1);
    return first_link_[r] + static_cast<std::uint32_t>(std::popcount(before));
  }
  /// The record to which a link that is not one-way leads, or kNoRecord.
  RecordIndex two_way(RecordIndex r, int q) const {
    return one_way_[r] >> q & 1 ? Grid::kNoRecord : grid_.destination(r, q);
  }
  std::vector<OneWayLink> find_one_way_links();
  void add_ghosts(std::span<const OneWayLink> links);
  void add_ghost(std::span<const OneWayLink> links);
  std::uint8_t find_mixed(RecordIndex r) const;

  const Grid& grid_;
  std::size_t row_size_;
  std::vector<DirectionMask> one_way_;         // by record
  std::vector<std::uint32_t> first_link_;      // by record: the number of its first one-way link
  std::vector<Node> ghost_of_;                 // by number of a one-way link
  std::vector<std::uint8_t> mixed_;            // by record: bit c, of the cell where it is corner c
  std::vector<bool> has_one_branch_;           // by record, so small that it stays in a cache
  std::vector<OneWayLink> ghost_links_;        // by ghost
  std::vector<std::uint32_t> ghost_first_{0};  // in ghost_links_
  std::vector<double> ghost_rows_;             // ghosts x row_size
};

}  // namespace hapgrid
