// The cells of a grid, their corners, and the moves from a cell to its neighbours (Sect. 2.4).
#pragma once

#include <array>
#include <cstdint>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// One of the 26 moves from a cell to a cell that shares a vertex with it: for each corner of the
/// new cell the corner of the old cell that supplies it, and the direction of that conversion, or
/// kKept where both are the same grid point.
struct CellSwitch {
  static constexpr std::uint8_t kKept = 255;
  std::array<std::uint8_t, 8> from{};
  std::array<std::uint8_t, 8> direction{};
  /// Bits of the axes of the move, and of those along which it goes up. Corner k of the old cell,
  /// if the new one has it, is corner k ^ moved there.
  int moved = 0, side = 0;

  /// Whether the new cell has a corner of the old one.
  bool keeps(int old_corner) const { return ((old_corner ^ side) & moved) == 0; }
};

namespace cell_detail {

constexpr std::array<std::array<int, 8>, 8> between_corners() {
  std::array<std::array<int, 8>, 8> between{};
  for (int from = 0; from < 8; ++from)
    for (int to = 0; to < 8; ++to) {
      std::array<int, 3> d{};
      for (int a = 0; a < 3; ++a) d[a] = (to >> a & 1) - (from >> a & 1);
      between[from][to] = (from == to ? -1 : Direction::of(d[0], d[1], d[2]).q());
    }
  return between;
}

/// Sect. 2.4, i) to iii) in one rule: along the axes of the move the source is the common corner,
/// along the others it has the index of the new corner. So a move across a face converts along one
/// axis; across an edge, three times from each of its ends; across a vertex, seven times from it.
constexpr std::array<CellSwitch, kDirections> cell_switches() {
  std::array<CellSwitch, kDirections> switches{};
  for (int q = 0; q < kDirections; ++q) {
    const auto move = Direction(q).step();
    for (int a = 0; a < 3; ++a) {
      switches[q].moved |= (move[a] != 0) << a;
      switches[q].side |= (move[a] > 0) << a;
    }
    for (int corner = 0; corner < 8; ++corner) {
      int from = 0;
      std::array<int, 3> d{};
      for (int a = 0; a < 3; ++a) {
        const int bit = corner >> a & 1;
        const int common = move[a] > 0 ? 0 : move[a] < 0 ? 1 : bit;  // in the new cell
        from |= (common + move[a]) << a;
        d[a] = bit - common;
      }
      switches[q].from[corner] = static_cast<std::uint8_t>(from);
      const bool kept = d == std::array<int, 3>{0, 0, 0};
      switches[q].direction[corner] =
          kept ? CellSwitch::kKept : static_cast<std::uint8_t>(Direction::of(d[0], d[1], d[2]).q());
    }
  }
  return switches;
}

}  // namespace cell_detail

/// The direction from one corner of a cell to another; -1 from a corner to itself.
inline constexpr auto kBetweenCorners = cell_detail::between_corners();

/// By the direction q of the move.
inline constexpr auto kCellSwitches = cell_detail::cell_switches();

/// The cells of one grid, each named by its base: the point of its corner (0,0,0). The grid must
/// outlive this object. Its links are not trusted: whatever they are, nothing is read outside it.
/// Everything but the constructor is real-time safe.
class Cells {
 public:
  explicit Cells(const Grid& grid) : grid_(grid) {
    const Box& box = grid.box();
    for (int a = 0; a < 3; ++a)
      if (box.counts[a] == 1) flat_ |= 1 << a;
    for (int corner = 0; corner < 8; ++corner) {
      GridCoordinates c{};
      for (int a = 0; a < 3; ++a) c[a] = distinct(corner) >> a & 1;
      corner_offset_[corner] = box.index(c);
    }
  }

  /// Whether the box has one point along an axis, so that each cell is flat there.
  bool is_flat(int axis) const { return flat_ >> axis & 1; }

  /// How many cells there are along an axis, flat cells included.
  std::uint32_t count(int axis) const { return is_flat(axis) ? 1 : grid_.box().counts[axis] - 1; }
  /// Whether no lower corner has the same grid point, as one has along a flat axis.
  bool is_corner(int corner) const { return (corner & flat_) == 0; }
  /// The lowest corner with the same grid point.
  int distinct(int corner) const { return corner & ~flat_; }
  /// The grid point of a corner.
  PointIndex point(PointIndex base, int corner) const { return base + corner_offset_[corner]; }

  /// The record to which direction q leads from a record, where it is known to lead to corner
  /// `corner` of the cell at `base`; Grid::kNoRecord as Grid::destination() says, which would
  /// compute the target and its neighbourhood again.
  RecordIndex destination(RecordIndex from, int q, PointIndex base, int corner) const noexcept {
    return destination(grid_.links(from), q, base, corner);
  }
  /// The same for a record with these links.
  RecordIndex destination(std::span<const Level, kDirections> links, int q, PointIndex base,
                          int corner) const noexcept {
    const PointIndex target = point(base, corner);
    const Level level = links[static_cast<std::size_t>(q)];
    return level < grid_.levels(target) ? grid_.first(target) + level : Grid::kNoRecord;
  }

 private:
  const Grid& grid_;
  int flat_ = 0;                             // bits of the axes with one point
  std::array<PointIndex, 8> corner_offset_;  // from the base, as point indices
};

}  // namespace hapgrid
