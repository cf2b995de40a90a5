// From a stream of HIP positions to a continuous stream of states (Sect. 2.4): the part of
// Algorithm 2 that every rule of traversal shares, which is where the HIP is. The rules, which say
// what the state is there, are classes of their own: PaperTraversal, BranchTraversal,
// ModelTraversal.
//
// Problem. A tick of the haptic loop has a millisecond at most, and it must never be delayed: it
// may not allocate, lock, read or write. Every position has a defined outcome, also a position that
// is not finite, outside the box, or a hundred cells away.
//
// Where is the HIP? Rounding (x - origin) / h decides differently from Box::position() near a grid
// point, and then a HIP on a face is in neither cell or in both. Here the cell's faces are the
// values of Box::position() themselves, the cell is closed, and the HIP leaves it only when it is
// beyond a face. So a HIP at rest on a face does not flap, a grid point gives exactly its stored
// state, and on a shared face, edge or vertex both cells give the same bits: the other corners have
// the weight 0 and the common ones the same weights in the same order of summation.
//
// Which corners? Eight pointers to rows. In a cell a copy of the states in an n x 8 block is no
// faster (n = 9: 19.0 against 18.8 ns), and each switch would have to make it; a copy of the whole
// grid in another layout would double the memory. It does help to prefetch the links of the new
// corners together with their states: the next switch finds them in the cache
// (tests/bench/interpolation.cpp).
//
// Jumps. When the HIP moved to a cell that shares no vertex with the old one, the traversal follows
// the straight line in equal parts, as many as there are cells between on the farthest axis. Each
// part then ends in a cell that shares at least a vertex with the cell before. (The alternative, a
// march through each face that the line crosses, takes more conversions and replaces diagonal ones
// by pairs, against which Sect. 2.4 warns.) The number of parts in one tick is bounded; when the
// bound is reached, the traversal goes on along the line in the next tick.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/grid/cell.hpp"

namespace hapgrid {

class Beside;
struct BesideAnswer;
class BranchNodes;

/// In Traversal::levels(): no record of the grid.
inline constexpr Level kNoLevel = 255;

/// What happened in a step. When all is false and zero, the HIP stayed in its cell.
struct StepResult {
  bool started = false;     ///< the traversal began, so nothing before the step counts
  bool not_finite = false;  ///< the HIP was not finite: nothing changed, the state is held
  bool outside = false;     ///< the HIP was outside the box and is held at the box's edge
  bool split = false;       ///< the HIP jumped to a cell that shares no vertex
  bool lagging = false;     ///< the bound on sub-steps was reached before the HIP
  bool blocked = false;     ///< a link leads nowhere (never in a playable grid): not followed
  /// By the paper's rule: some conversion led to another level number than it came from. By the one
  /// that stays on a branch: `snapped`.
  bool level_changed = false;
  bool snapped = false;  ///< the state jumped to another branch, as the model does there
  /// The level, at the grid point nearest to position(), whose state the hand chose and got; the
  /// step has then snapped, too.
  Level chosen = kNoLevel;
  std::uint16_t face_switches = 0;
  std::uint16_t edge_switches = 0;
  std::uint16_t vertex_switches = 0;
  /// The step follows the same answer of the model as the one before.
  bool still_held = false;
  std::int8_t direction = -1;  ///< of the last switch to another cell; -1: there was none
  /// Some corner that the cells before and after the step share has another node. False where the
  /// HIP jumped to a cell that shares none.
  bool corners_changed = false;
  std::array<RecordIndex, 8> nodes_before{};  ///< nodes() before the step, where corners changed
  Vec3 from{0, 0, 0};                         ///< position() before the step

  /// Whether state() belongs to this HIP, or at least to its place a moment ago.
  bool usable() const { return !not_finite && !blocked; }
  /// Whether the state does not go on from where it was.
  bool jumped() const { return started || snapped; }
};

/// The traversal of one grid by one HIP; for one thread.
/// start() and step() are real-time safe. The grid must outlive the traversal. It is not trusted:
/// whatever its links are, no step reads outside it.
class Traversal {
 public:
  static constexpr std::uint16_t kDefaultMaxSubSteps = 64;

  virtual ~Traversal() = default;

  /// Starts in the cell of the HIP, in the state that has this level at the grid point nearest to
  /// it. @returns last_step()
  const StepResult& start(const Vec3& hip, Level level = 0) noexcept;
  /// Follows the HIP. Until a start has succeeded it does the same as start().
  /// @param next the hand wants another state: that of the next level, in their order, at the grid
  /// point nearest to the HIP. Where there is no other, nothing happens. @returns last_step()
  const StepResult& step(const Vec3& hip, bool next = false) noexcept;
  const StepResult& last_step() const { return step_; }

  /// The state there, n values in the model's units; zeros before the first start.
  std::span<const double> state() const {
    return std::span<const double>(row_).first(grid_.state_size());
  }
  /// The state and what the grid stores with it; spec().row_size() values.
  std::span<const double> row() const { return row_; }
  /// The place of state(), in the model's unit of length: the HIP, clamped to the box; after a step
  /// that was not usable or is lagging, a former place.
  const Vec3& position() const { return position_; }
  /// The record in corner i + 2j + 4k of the cell; Grid::kNoRecord where the rule has none.
  const std::array<RecordIndex, 8>& records() const { return records_; }
  /// Their levels; kNoLevel where there is no record.
  const std::array<Level, 8>& levels() const { return levels_; }
  /// The nodes that state() is interpolated from, by corner: a record, or from Grid::records() on a
  /// ghost (branch_nodes.hpp); Grid::kNoRecord where the rule has none.
  const std::array<RecordIndex, 8>& nodes() const { return nodes_; }
  /// The branches whose ghosts are among them; null where the rule has none.
  virtual const BranchNodes* branch_nodes() const { return nullptr; }
  /// From now on the model corrects state and force, where it keeps up. A rule that has no branches
  /// ignores it. @param beside of the same grid; it is told of each step, and outlives this.
  virtual void walk_beside(Beside*) {}
  /// The model's answer that the last step followed; null where there was none.
  virtual const BesideAnswer* followed() const { return nullptr; }
  /// Where position() is in the cell, in [0, 1] on each axis.
  Vec3 part() const noexcept { return part_of_cell(position_); }
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
  /// Counts the ticks in which the state jumped, because it started or snapped.
  std::uint64_t jumps() const { return jumps_; }
  /// The corner (0,0,0) of the cell.
  const GridCoordinates& cell() const { return cell_; }

 protected:
  /// @param max_sub_steps the most sub-steps (cells, for a straight jump) in one step, >= 1.
  /// @throw Error when neighbouring grid points coincide in double precision.
  Traversal(const Grid& grid, std::uint16_t max_sub_steps);
  Traversal(const Traversal&) = default;

  // What a rule answers. Each of these is real-time safe.

  /// Begins at position(), which is nearest to the corner `nearest` of the cell, in the state that
  /// has this level there. False when a link or the level is missing, or when the hand chose this
  /// level (last_step() is no start) and its branch ends before position(): then nothing changes.
  virtual bool begin(int nearest, Level level) noexcept = 0;
  /// Of the present state in a corner of the cell; kNoLevel where it has none.
  virtual Level level_at(int corner) const noexcept { return levels_[corner]; }
  /// Changes to the neighbouring cell at `base`, in direction q, on the way to y in that cell.
  /// Until it returns, the cell is the one before. False when a link is missing: then nothing
  /// changes.
  virtual bool cross(int q, PointIndex base, const Vec3& y, StepResult& result) noexcept = 0;
  /// Moves on from position() to x, which is in the closed cell. False when that cannot be.
  virtual bool move(const Vec3& x, StepResult& result) noexcept = 0;
  /// Once in each step that is usable, when position() is settled: decides between states that the
  /// place allows, for rules that know more of the hand than its place.
  virtual void settle(StepResult&) noexcept {}
  /// Sets row() to what is at position().
  virtual void evaluate() noexcept = 0;

  /// The point of the current closed cell that is nearest to x.
  Vec3 nearest_in_cell(const Vec3& x) const noexcept {
    return {std::clamp(x[0], low_[0], high_[0]), std::clamp(x[1], low_[1], high_[1]),
            std::clamp(x[2], low_[2], high_[2])};
  }
  PointIndex base() const { return base_; }

  const Grid& grid_;
  const Cells cells_;
  const Box box_;
  std::array<RecordIndex, 8> records_{};
  std::array<Level, 8> levels_{};
  std::array<RecordIndex, 8> nodes_{};
  std::vector<double> row_;

 private:
  double face(int axis, std::int64_t c) const {
    return box_.origin[axis] + box_.spacing * static_cast<double>(c);
  }
  bool clamp(Vec3& x) const noexcept;
  std::int64_t cells_away(int axis, double x) const noexcept;
  std::array<std::int64_t, 3> cells_away(const Vec3& x) const noexcept;
  void finish() noexcept;
  void travel(const Vec3& x) noexcept;
  bool switch_cell(const std::array<std::int64_t, 3>& move, const Vec3& y) noexcept;
  void choose_next() noexcept;
  void compare_corners(const std::array<RecordIndex, 8>& before) noexcept;
  void enter(const GridCoordinates& cell, PointIndex base) noexcept;

  const int max_sub_steps_;
  Vec3 box_low_;
  Vec3 box_high_;
  bool started_ = false;
  StepResult step_;
  std::uint64_t jumps_ = 0;
  Vec3 position_{0, 0, 0};
  GridCoordinates cell_{0, 0, 0};
  PointIndex base_ = 0;  // the point of cell_
  Vec3 low_{0, 0, 0};    // the closed cell: low_ <= x <= high_
  Vec3 high_{0, 0, 0};
  Vec3 scale_{1, 1, 1};  // 1 / (high_ - low_), rounded so that high_ gives at least 1
};

/// Weights of the corners i + 2j + 4k at xbar, dimensionless in [0,1]^3; they are >= 0, sum to 1
/// within 4 epsilon, and at a corner one is exactly 1 and the others exactly 0.
/// Source: Sect. 2.4. Deviation: the printed weights are mirrored; (1-i)(1-x) + i x is used.
std::array<double, 8> corner_weights(const Vec3& xbar) noexcept;

/// out = the sum of w[k] rows[k], in an order of summation that never changes.
void blend(const std::array<double, 8>& w, const std::array<const double*, 8>& rows,
           std::span<double> out) noexcept;

}  // namespace hapgrid
