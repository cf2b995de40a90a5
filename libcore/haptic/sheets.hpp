// The branches of a grid as sheets: what of each branch lies at the points of a cell, also where
// the branch ends.
//
// Records that two-way links connect are one branch. Where a link is one-way, the model snaps on
// the way: the branch of its record ends before the point to which the link leads. There it gets a
// *ghost*: the row that it would have at that point if it did not end, extrapolated along the
// branch. So a branch has a row in all corners of a cell in which it ends, and it can be
// interpolated up to the place where the model snaps (tear_function.hpp says where that is).
//
// One point can have ghosts of several branches. Two records beside it belong to the same one when
// two-way links connect them, directly or by other records that end before this point.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/ranked_bits.hpp"
#include "libcore/grid/cell.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/grid/point_bits.hpp"

namespace hapgrid {

/// A record (below Grid::records()), or a ghost.
using Node = std::uint32_t;

class Sheets {
 public:
  static constexpr Node kNoNode = Grid::kNoRecord;

  /// Looks at the grid in all threads of the machine.
  /// @param grid outlives this. Its links are not trusted.
  explicit Sheets(const Grid& grid);

  bool is_ghost(Node node) const { return node >= grid_.records(); }
  Node ghosts() const { return static_cast<Node>(ghost_points_.size()); }
  /// Where the branch of record r is at its neighbour in direction q; kNoNode where there is no
  /// link. Real-time safe, as all that follow.
  Node node(RecordIndex r, int q) const noexcept {
    const Ends* const ends = ends_of(r);
    return ends && ends->has(q) ? ghost_of_[ends->number(q)] : grid_.destination(r, q);
  }
  /// The same where the neighbour is known to be corner `corner` of the cell at `base`.
  Node node(RecordIndex r, int q, const Cells& cells, PointIndex base, int corner) const noexcept {
    const Ends* const ends = ends_of(r);
    return ends && ends->has(q) ? ghost_of_[ends->number(q)]
                                : cells.destination(r, q, base, corner);
  }
  /// The directions in which the branch of record r ends before the neighbour.
  DirectionMask one_way(RecordIndex r) const noexcept {
    const Ends* const ends = ends_of(r);
    return ends ? ends->one_way : 0;
  }
  /// Whether no branch ends in the cells around record r, and none of them is mixed.
  bool is_whole(RecordIndex r) const noexcept { return !ends_of(r) && !is_mixed_.has(r); }
  /// Whether the cell in which record r is corner `corner` is mixed: two other records of the
  /// branch in this cell are not of one branch themselves.
  bool is_mixed(RecordIndex r, int corner) const noexcept {
    return is_mixed_.has(r) && (mixed_[is_mixed_.rank(r)] >> corner & 1);
  }
  /// Which corners of a cell have records that are not of one branch: bit b of entry a, a < b.
  /// Corners that are ghosts or kNoNode belong to any branch.
  std::array<std::uint8_t, 8> apart(const std::array<Node, 8>& corners) const noexcept;
  /// Calls use(r, q) for each one-way link of records [64 begin, 64 end), ascending; `end` is at
  /// most words_of_ends().
  template <class Use>
  void for_each_end(std::size_t begin, std::size_t end, Use&& use) const {
    has_ends_.for_each(begin, end, [&](std::size_t r) {
      const DirectionMask one_way = ends_of(static_cast<RecordIndex>(r))->one_way;
      for (DirectionMask left = one_way; left != 0; left &= left - 1)
        use(static_cast<RecordIndex>(r), std::countr_zero(left));
    });
  }
  std::size_t words_of_ends() const { return has_ends_.words(); }
  /// The one-way links for which a ghost stands, ascending.
  struct GhostEnd {
    RecordIndex from;
    std::uint8_t q;
  };
  std::span<const GhostEnd> ends_of_ghost(Node node) const noexcept {
    const std::size_t ghost = node - grid_.records();
    return std::span(ghost_ends_)
        .subspan(ghost_first_[ghost], ghost_first_[ghost + 1] - ghost_first_[ghost]);
  }
  /// Calls use(r, corner) for each is_mixed(r, corner), ascending.
  template <class Use>
  void for_each_mixed(Use&& use) const {
    is_mixed_.for_each(0, is_mixed_.words(), [&](std::size_t r) {
      for (int corner = 0; corner < 8; ++corner)
        if (is_mixed(static_cast<RecordIndex>(r), corner)) use(static_cast<RecordIndex>(r), corner);
    });
  }
  const double* row(Node node) const noexcept {
    return is_ghost(node) ? &ghost_rows_[std::size_t{node - grid_.records()} * row_size_]
                          : grid_.row(node).data();
  }
  PointIndex point(Node node) const noexcept {
    return is_ghost(node) ? ghost_points_[node - grid_.records()] : grid_.point(node);
  }

 private:
  struct Ends {
    DirectionMask one_way = 0;
    std::uint32_t first = 0;  // its ghosts in ghost_of_, by direction

    bool has(int q) const noexcept { return one_way >> q & 1; }
    std::uint32_t number(int q) const noexcept {
      const DirectionMask before = one_way & ((DirectionMask{1} << q) - 1);
      return first + static_cast<std::uint32_t>(std::popcount(before));
    }
  };
  /// A one-way link, by the point before which its branch ends.
  struct End {
    PointIndex point;
    RecordIndex from;
    std::uint8_t q;
  };

  /// Null where the branch of record r does not end.
  const Ends* ends_of(RecordIndex r) const noexcept {
    return has_ends_.has(r) ? &ends_[has_ends_.rank(r)] : nullptr;
  }
  /// What a corner's record says of the others in its cell.
  struct View {
    const Level* links = nullptr;  // null: no record, or a ghost
    DirectionMask one_way = 0;
    Level level = 0;
  };
  View view(Node node) const noexcept;
  static std::array<std::uint8_t, 8> apart(const std::array<View, 8>& corners) noexcept;

  const double* two_way_row(RecordIndex r, int q) const;
  std::vector<End> find_ends();
  void find_mixed_records();
  void add_ghosts(std::span<const End> ends_at_point);
  void add_ghost(std::span<const End> ends, const std::vector<std::uint32_t>& branch,
                 std::uint32_t which);
  std::uint8_t find_mixed(PointIndex p, Level level) const;

  const Grid& grid_;
  std::size_t row_size_;
  // Of most records no branch ends around them, and they are not mixed: the others have an entry.
  RankedBits has_ends_;
  std::vector<Ends> ends_;
  std::vector<Node> ghost_of_;  // by one-way link
  RankedBits is_mixed_;
  std::vector<std::uint8_t> mixed_;  // bit c: of the cell where the record is corner c
  std::vector<GhostEnd> ghost_ends_;
  std::vector<std::uint32_t> ghost_first_{0};  // in ghost_ends_
  std::vector<PointIndex> ghost_points_;
  std::vector<double> ghost_rows_;  // ghosts x row_size
};

}  // namespace hapgrid
