// Where the HIP is: the cells through which it goes in a tick (Sect. 2.4). What the state is there
// says a rule: PaperTraversal, BranchTraversal, ModelTraversal.
//
// Problem. A tick of the haptic loop has a millisecond at most, and it must never be delayed: it
// may not allocate, lock, read or write. Every position has a defined outcome, also a position that
// is not finite, outside the box, or a hundred cells away.
//
// Which cell? Rounding (x - origin) / h decides differently from Box::position() near a grid
// point, and then a HIP on a face is in neither cell or in both. Here the cell's faces are the
// values of Box::position() themselves, the cell is closed, and the HIP leaves it only when it is
// beyond a face. So a HIP at rest on a face does not flap, a grid point gives exactly its stored
// state, and on a shared face, edge or vertex both cells give the same bits: the other corners have
// the weight 0 and the common ones the same weights in the same order of summation.
//
// Jumps. When the HIP moved to a cell that shares no vertex with the old one, the walk follows
// the straight line in equal parts, as many as there are cells between on the farthest axis. Each
// part then ends in a cell that shares at least a vertex with the cell before. (The alternative, a
// march through each face that the line crosses, takes more conversions and replaces diagonal ones
// by pairs, against which Sect. 2.4 warns.) The number of parts in one tick is bounded; when the
// bound is reached, the walk goes on along the line in the next tick.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "libcore/grid/cell.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

/// The way of one HIP through the cells of one grid. Everything but the constructor is real-time
/// safe. The grid must outlive the walk.
class CellWalk {
 public:
  static constexpr std::uint16_t kDefaultMaxParts = 64;

  /// A part of the way of a tick. It ends in the present cell, or in one that shares a vertex.
  struct Part {
    Vec3 to;          ///< in the closed cell at `base`
    PointIndex base;  ///< the corner (0,0,0) of that cell
    int q;            ///< the direction to that cell; -1: it is the present one
  };

  /// @param most_parts in a tick (cells, for a straight jump), >= 1
  /// @throw Error when neighbouring grid points coincide in double precision.
  CellWalk(const Grid& grid, std::uint16_t most_parts);

  const Cells& cells() const { return cells_; }
  const Vec3& position() const { return position_; }
  /// The corner (0,0,0) of the cell, by coordinates and as a point.
  const GridCoordinates& cell() const { return cell_; }
  PointIndex base() const { return base_; }
  /// Where x is in the cell, for a point of the closed cell; exactly 0 and 1 on its faces.
  Vec3 part_of_cell(const Vec3& x) const noexcept {
    const auto part = [&](int a) { return std::min((x[a] - low_[a]) * scale_[a], 1.0); };
    return {part(0), part(1), part(2)};
  }
  /// The same for a place beside the cell, where it is less than 0 or more than 1.
  Vec3 part_beside_cell(const Vec3& x) const noexcept {
    Vec3 part{0, 0, 0};
    for (int a = 0; a < 3; ++a)
      if (!cells_.is_flat(a)) part[a] = (x[a] - box_.origin[a]) / box_.spacing - cell_[a];
    return part;
  }
  /// The corner nearest to position(); the lower one of two.
  int nearest_corner() const noexcept;
  /// The point of the closed cell that is nearest to x.
  Vec3 nearest_in_cell(const Vec3& x) const noexcept {
    return {std::clamp(x[0], low_[0], high_[0]), std::clamp(x[1], low_[1], high_[1]),
            std::clamp(x[2], low_[2], high_[2])};
  }
  bool has(const Vec3& x) const noexcept {
    return x[0] >= low_[0] && x[0] <= high_[0] && x[1] >= low_[1] && x[1] <= high_[1] &&
           x[2] >= low_[2] && x[2] <= high_[2];
  }
  /// Moves x to the nearest place of the box. @returns whether it was outside
  bool clamp(Vec3& x) const noexcept;

  /// Begins at x, in the box. @returns the corner of its cell that is nearest to it
  int begin(const Vec3& x) noexcept;
  /// Gives up a beginning: the position, without its cell.
  void give_up(const Vec3& position) noexcept { position_ = position; }
  /// The way of a tick leads to x, in the box.
  void aim(const Vec3& x) noexcept {
    aim_in_cell(x);
    is_in_cell_ = has(x);
  }
  /// The same where has(x).
  void aim_in_cell(const Vec3& x) noexcept {
    aim_ = x;
    is_in_cell_ = true;
    parts_ = 0;
    has_arrived_ = is_split_ = is_lagging_ = false;
  }
  /// The next part of it; nothing when it has come to its end, or to the most parts of a tick.
  std::optional<Part> next() noexcept {
    if (has_arrived_) return std::nullopt;
    if (!is_in_cell_) return next_to_cell();
    has_arrived_ = true;
    return Part{aim_, base_, -1};
  }
  /// Goes there.
  void go(const Part& part) noexcept {
    position_ = part.to;
    if (part.q >= 0) enter_from(part);
  }
  /// Of this tick: whether the HIP jumped to a cell that shares no vertex, and whether the most
  /// parts were reached before the HIP.
  bool is_split() const { return is_split_; }
  bool is_lagging() const { return is_lagging_; }

 private:
  double face(int axis, std::int64_t c) const {
    return box_.origin[axis] + box_.spacing * static_cast<double>(c);
  }
  std::int64_t cells_away(int axis, double x) const noexcept;
  std::array<std::int64_t, 3> cells_away(const Vec3& x) const noexcept;
  std::optional<Part> next_to_cell() noexcept;
  void enter_from(const Part& part) noexcept;
  void enter(int axis, std::uint32_t c) noexcept;

  const Grid& grid_;
  const Cells cells_;
  const Box box_;
  const int most_parts_;
  Vec3 box_low_;
  Vec3 box_high_;

  Vec3 position_{0, 0, 0};
  GridCoordinates cell_{0, 0, 0};
  PointIndex base_ = 0;  // the point of cell_
  Vec3 low_{0, 0, 0};    // the closed cell: low_ <= x <= high_
  Vec3 high_{0, 0, 0};
  Vec3 scale_{1, 1, 1};  // 1 / (high_ - low_), rounded so that high_ gives at least 1

  Vec3 aim_{0, 0, 0};
  bool is_in_cell_ = true;  // the way of this tick
  int parts_ = 0;           // of this tick, so far
  bool has_arrived_ = true;
  bool is_split_ = false;
  bool is_lagging_ = false;
};

}  // namespace hapgrid
