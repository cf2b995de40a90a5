// From a stream of HIP positions to a continuous stream of states (Sect. 2.4). A rule of traversal
// follows the walk of the HIP from cell to cell (cell_walk.hpp), and says what the state is there:
// PaperTraversal, BranchTraversal, ModelTraversal. This is what all three have in common, for those
// who play.
//
// Which corners? Eight pointers to rows. In a cell a copy of the states in an n x 8 block is no
// faster, and each switch would have to make it; a copy of the whole grid in another layout would
// double the memory. It does help to prefetch, together with the states of the new corners, what
// the next switch reads if the hand goes straight on: their links, and where the records of the
// next points begin (tests/bench/interpolation.cpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libcore/follow/cell_walk.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

class Beside;
class BranchNodes;

/// In Traversal::levels(): no record of the grid.
inline constexpr Level kNoLevel = 255;

/// What happened in a step. When all is false and zero, the HIP stayed in its cell.
struct StepResult {
  bool started = false;     ///< the traversal began, so nothing before the step counts
  bool not_finite = false;  ///< the HIP was not finite: nothing changed, the state is held
  bool outside = false;     ///< the HIP was outside the box and is held at the box's edge
  bool split = false;       ///< the HIP jumped to a cell that shares no vertex
  bool lagging = false;     ///< the most parts of a tick were reached before the HIP
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

  /// Whether state() belongs to this HIP, or at least to its place a moment ago.
  bool usable() const { return !not_finite && !blocked; }
  /// Whether the state does not go on from where it was.
  bool jumped() const { return started || snapped; }
};

/// What the corners of the cell were before a step.
struct CornersBefore {
  Vec3 from{0, 0, 0};                  ///< position() then
  std::int8_t direction = -1;          ///< of the last switch to another cell; -1: there was none
  std::array<RecordIndex, 8> nodes{};  ///< nodes() then
  /// Some corner that the cells before and after the step share has another node. False where the
  /// HIP jumped to a cell that shares none.
  bool have_changed = false;

  /// Before a step. Member by member: a compiler makes a temporary of a whole, which a processor
  /// has to wait for.
  void keep(const Vec3& position, const std::array<RecordIndex, 8>& corners) noexcept {
    from = position;
    direction = -1;
    nodes = corners;
    have_changed = false;
  }
};

/// What the model beside the grid (beside.hpp) says of the place where the hand will be when this
/// answer comes.
struct BesideAnswer {
  std::uint64_t tick = 0;     ///< Beside::tick() when it was asked
  bool usable = false;        ///< the model could follow the hand
  Vec3 at{0, 0, 0};           ///< that place, in the model's unit of length
  std::vector<double> row;    ///< GridSpec::row_size() values: state, and what is stored
  std::optional<Vec3> force;  ///< newtons; nothing: the model does not say
};

/// The traversal of one grid by one HIP; for one thread.
/// start() and step() are real-time safe. The grid must outlive the traversal. It is not trusted:
/// whatever its links are, no step reads outside it.
class Traversal {
 public:
  virtual ~Traversal() = default;

  /// Starts in the cell of the HIP, in the state that has this level at the grid point nearest to
  /// it. @returns last_step()
  virtual const StepResult& start(const Vec3& hip, Level level) noexcept = 0;
  const StepResult& start(const Vec3& hip) noexcept { return start(hip, 0); }
  /// Follows the HIP. Until a start has succeeded it does the same as start().
  /// @param next the hand wants another state: that of the next level, in their order, at the grid
  /// point nearest to the HIP. Where there is no other, nothing happens. @returns last_step()
  virtual const StepResult& step(const Vec3& hip, bool next) noexcept = 0;
  const StepResult& step(const Vec3& hip) noexcept { return step(hip, false); }
  const StepResult& last_step() const { return step_; }
  const CornersBefore& corners_before() const { return before_; }

  /// The state there, n values in the model's units; zeros before the first start.
  std::span<const double> state() const {
    return std::span<const double>(row_).first(grid_.state_size());
  }
  /// The state and what the grid stores with it; spec().row_size() values.
  std::span<const double> row() const { return row_; }
  /// The place of state(), in the model's unit of length: the HIP, clamped to the box; after a step
  /// that was not usable or is lagging, a former place.
  const Vec3& position() const { return walk_.position(); }
  /// Its cell, and where it is in the cell.
  const CellWalk& walk() const { return walk_; }
  /// The corner (0,0,0) of the cell.
  const GridCoordinates& cell() const { return walk_.cell(); }
  /// Where position() is in the cell, in [0, 1] on each axis.
  Vec3 part() const noexcept { return walk_.part_of_cell(position()); }
  /// The record in corner i + 2j + 4k of the cell; Grid::kNoRecord where the rule has none.
  std::array<RecordIndex, 8> records() const noexcept;
  /// Their levels; kNoLevel where there is no record.
  std::array<Level, 8> levels() const noexcept;
  /// The nodes that state() is interpolated from, by corner: a record, or from Grid::records() on a
  /// ghost (branch_nodes.hpp); Grid::kNoRecord where the rule has none.
  const std::array<RecordIndex, 8>& nodes() const { return nodes_; }
  /// Counts the ticks in which the state jumped, because it started or snapped.
  std::uint64_t jumps() const { return jumps_; }

  /// The branches whose ghosts are among the nodes; null where the rule has none.
  virtual const BranchNodes* branch_nodes() const { return nullptr; }
  /// From now on the model corrects state and force, where it keeps up. A rule that has no branches
  /// ignores it. @param beside of the same grid; it is told of each step, and outlives this.
  virtual void walk_beside(Beside*) {}
  /// The model's answer that the last step followed; null where there was none.
  virtual const BesideAnswer* followed() const { return nullptr; }
  /// Whether that is the answer that the step before followed, too.
  virtual bool follows_as_before() const { return false; }

 protected:
  /// @throw Error as CellWalk does
  Traversal(const Grid& grid, std::uint16_t most_parts)
      : grid_(grid), walk_(grid, most_parts), row_(grid.spec().row_size(), 0.0) {
    nodes_.fill(Grid::kNoRecord);
  }
  Traversal(const Traversal&) = default;

  // The beginnings and ends that the steps of all rules have.

  /// @returns the corner nearest to the HIP, or nothing when the HIP is not finite
  std::optional<int> begin_start(const Vec3& hip) noexcept;
  const StepResult& end_start(bool has_begun) noexcept;
  /// @returns whether there is a way to follow
  bool begin_step(const Vec3& hip) noexcept;
  void count_switch(const CellWalk::Part& part) noexcept;
  const StepResult& end_step() noexcept;
  /// Takes the next other level, in their order, of a corner's grid point.
  /// @param present the level there now; kNoLevel: none
  /// @param take bool (Level): whether the state could be taken
  template <class Take>
  void choose_next(int corner, Level present, const Take& take) noexcept {
    const int levels = grid_.levels(walk_.cells().point(walk_.base(), corner));
    for (int i = 1; i <= levels; ++i) {
      const auto level = static_cast<Level>((present == kNoLevel ? i - 1 : present + i) % levels);
      if (level == present || !take(level)) continue;
      step_.chosen = level;
      step_.snapped = step_.level_changed = true;
      return;
    }
  }

  const Grid& grid_;
  CellWalk walk_;
  bool has_started_ = false;
  StepResult step_;
  CornersBefore before_;
  std::array<RecordIndex, 8> nodes_{};
  std::vector<double> row_;

 private:
  std::uint64_t jumps_ = 0;
};

/// Weights of the corners i + 2j + 4k at xbar, dimensionless in [0,1]^3; they are >= 0, sum to 1
/// within 4 epsilon, and at a corner one is exactly 1 and the others exactly 0.
/// Source: Sect. 2.4. Deviation: the printed weights are mirrored; (1-i)(1-x) + i x is used.
std::array<double, 8> corner_weights(const Vec3& xbar) noexcept;

/// out = the sum of w[k] rows[k], in an order of summation that never changes.
void blend(const std::array<double, 8>& w, const std::array<const double*, 8>& rows,
           std::span<double> out) noexcept;

/// Keeps a state or a force from jumping where the traversal changes corners without a snap: the
/// difference at the place of the change is added to it, and fades while the hand moves on by half
/// a spacing. Where the model walks beside the grid (beside.hpp), what the interpolation lacks to
/// the model's state and force is added, too. This difference is *held*: it does not fade until the
/// model's answers fail to come. Everything but the constructor is real-time safe.
class FadingOffset {
 public:
  /// @param size how many numbers it has. @param spacing of the grid
  FadingOffset(std::size_t size, double spacing) : values_(size), held_(size), way_(spacing / 2) {}

  bool is_held() const { return is_held_; }
  void end() noexcept {
    left_ = 0;
    is_held_ = false;
  }
  /// @returns the numbers, to which the caller adds the difference at a change of corners. If
  /// nothing is held, they begin to fade anew.
  std::span<double> renew() noexcept {
    if (is_held_) return held_;
    if (left_ == 0) std::fill(values_.begin(), values_.end(), 0.0);
    left_ = way_;
    return values_;
  }
  /// Holds other numbers from now on. If none were held, the sum of all goes on from where it was,
  /// unless it shall jump.
  /// @param next as many numbers
  void hold(std::span<const double> next, bool jumps) noexcept {
    if (!is_held_ && !jumps) {
      const std::span<double> fading = renew();
      for (std::size_t i = 0; i < next.size(); ++i) fading[i] -= next[i];
    }
    std::copy(next.begin(), next.end(), held_.begin());
    is_held_ = true;
  }
  /// What was held begins to fade.
  void let_go() noexcept {
    if (!is_held_) return;
    is_held_ = false;
    const std::span<double> fading = renew();
    for (std::size_t i = 0; i < held_.size(); ++i) fading[i] += held_[i];
  }
  /// The hand moves from one place to another.
  void fade(const Vec3& from, const Vec3& to) noexcept {
    if (left_ == 0) return;
    const double moved = length_of(to - from);
    if (moved >= left_) {
      left_ = 0;
      return;
    }
    const double part = 1 - moved / left_;
    for (double& value : values_) value *= part;
    left_ -= moved;
  }
  /// @param out as many numbers
  void add_to(std::span<double> out) const noexcept {
    for (std::size_t i = 0; left_ > 0 && i < out.size(); ++i) out[i] += values_[i];
    for (std::size_t i = 0; is_held_ && i < out.size(); ++i) out[i] += held_[i];
  }

 private:
  std::vector<double> values_;
  std::vector<double> held_;
  double way_;
  double left_ = 0;  // of the way on which the values fade
  bool is_held_ = false;
};

}  // namespace hapgrid
