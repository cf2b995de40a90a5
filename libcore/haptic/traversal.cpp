#include "libcore/haptic/traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::int64_t farthest(const std::array<std::int64_t, 3>& cells) {
  return std::max({std::abs(cells[0]), std::abs(cells[1]), std::abs(cells[2])});
}

}  // namespace

Traversal::Traversal(const Grid& grid, std::uint16_t max_sub_steps)
    : grid_(grid),
      cells_(grid),
      box_(grid.box()),
      row_(grid.spec().row_size(), 0.0),
      max_sub_steps_(std::max<int>(max_sub_steps, 1)) {
  nodes_.fill(Grid::kNoRecord);
  for (int a = 0; a < 3; ++a) {
    box_low_[a] = face(a, 0);
    box_high_[a] = face(a, box_.counts[a] - 1);
    for (std::int64_t c = 1; c < box_.counts[a]; ++c) {
      const double width = face(a, c) - face(a, c - 1);
      if (!(width > 0 && std::isfinite(1 / width)))
        throw Error(format(
            "grid: neighbouring points coincide in double precision along axis {}, near {:f}", a,
            face(a, c)));
    }
    if (!std::isfinite(box_high_[a] - box_low_[a]))
      throw Error(format("grid: the box is too large for double precision along axis {}", a));
  }
}

const StepResult& Traversal::start(const Vec3& hip, Level level) noexcept {
  step_ = {.started = true, .from = position_};
  started_ = false;
  ++jumps_;
  if (!finite(hip)) {
    step_.not_finite = true;
    return step_;
  }
  Vec3 x = hip;
  step_.outside = clamp(x);

  GridCoordinates cell{};
  int nearest = 0;
  for (int a = 0; a < 3; ++a) {
    if (cells_.is_flat(a)) continue;
    const std::int64_t last = std::int64_t{cells_.count(a)} - 1;
    auto c = std::min(static_cast<std::int64_t>((x[a] - box_.origin[a]) / box_.spacing), last);
    while (c > 0 && x[a] < face(a, c)) --c;
    while (c < last && x[a] >= face(a, c + 1)) ++c;
    cell[a] = static_cast<std::uint32_t>(c);
    if (x[a] - face(a, c) > face(a, c + 1) - x[a]) nearest |= 1 << a;
  }

  enter(cell, box_.index(cell));
  position_ = x;
  started_ = begin(nearest, level);
  step_.blocked = !started_;
  if (started_) {
    settle(step_);
    evaluate();
  } else {
    position_ = step_.from;
  }
  return step_;
}

const StepResult& Traversal::step(const Vec3& hip, bool next) noexcept {
  // The most frequent case comes first: a HIP in the closed cell is finite and in the box.
  if (started_ && hip[0] >= low_[0] && hip[0] <= high_[0] && hip[1] >= low_[1] &&
      hip[1] <= high_[1] && hip[2] >= low_[2] && hip[2] <= high_[2]) {
    step_ = {.from = position_};
    if (move(hip, step_)) {
      position_ = hip;
      if (next) choose_next();
      settle(step_);
    } else {
      step_.blocked = true;
    }
    finish();
    return step_;
  }
  if (!started_) return start(hip);
  step_ = {.from = position_};
  if (!finite(hip)) {
    step_.not_finite = true;
    return step_;
  }
  Vec3 x = hip;
  step_.outside = clamp(x);
  const std::array<RecordIndex, 8> before = nodes_;
  travel(x);
  if (next && !step_.blocked) choose_next();
  if (!step_.blocked) settle(step_);
  compare_corners(before);
  finish();
  return step_;
}

void Traversal::finish() noexcept {
  jumps_ += step_.snapped;
  evaluate();
}

bool Traversal::clamp(Vec3& x) const noexcept {
  bool outside = false;
  for (int a = 0; a < 3; ++a) {
    if (x[a] < box_low_[a]) {
      x[a] = box_low_[a];
      outside = true;
    } else if (x[a] > box_high_[a]) {
      x[a] = box_high_[a];
      outside = true;
    }
  }
  return outside;
}

/// How many cells lie between the current cell and that of x along an axis. x is inside the box; a
/// coordinate on a face belongs to the nearer cell. The first guess is off by one at most when the
/// spacing is well above the rounding of coordinates; the loops end at the box in any case.
std::int64_t Traversal::cells_away(int a, double x) const noexcept {
  const std::int64_t here = cell_[a];
  const auto guess = [&] { return static_cast<std::int64_t>((x - box_.origin[a]) / box_.spacing); };
  if (x > high_[a]) {
    const std::int64_t last = std::int64_t{cells_.count(a)} - 1;
    std::int64_t c = std::clamp(guess(), here + 1, last);
    while (c > here + 1 && x <= face(a, c)) --c;
    while (c < last && x > face(a, c + 1)) ++c;
    return c - here;
  }
  if (x < low_[a]) {
    std::int64_t c = std::clamp(guess(), std::int64_t{0}, here - 1);
    while (c < here - 1 && x >= face(a, c + 1)) ++c;
    while (c > 0 && x < face(a, c)) --c;
    return c - here;
  }
  return 0;
}

std::array<std::int64_t, 3> Traversal::cells_away(const Vec3& x) const noexcept {
  return {cells_away(0, x[0]), cells_away(1, x[1]), cells_away(2, x[2])};
}

/// Moves to x, which is inside the box and outside the cell, as far as links and the bound allow.
void Traversal::travel(const Vec3& x) noexcept {
  for (int sub_steps = 0;; ++sub_steps) {
    auto away = cells_away(x);
    const std::int64_t distance = farthest(away);
    Vec3 y = x;
    if (distance > 1) {
      step_.split = true;
      if (sub_steps == max_sub_steps_) {
        step_.lagging = true;
        return;
      }
      // The first of `distance` equal parts ends in a neighbouring cell, except for rounding. Then
      // half of that part is tried, and so on: position_ is in the cell, so some part is short
      // enough.
      for (auto parts = static_cast<double>(distance);; parts *= 2) {
        for (int a = 0; a < 3; ++a) y[a] = position_[a] + (x[a] - position_[a]) / parts;
        away = cells_away(y);
        if (farthest(away) <= 1) break;
      }
    } else if (sub_steps == max_sub_steps_ && distance == 1) {
      step_.lagging = true;
      return;
    }
    const GridCoordinates cell = cell_;
    const PointIndex base = base_;
    if ((farthest(away) > 0 && !switch_cell(away, y)) || !move(y, step_)) {
      // Only the model can refuse to move; it has no corners. position_ must be in the cell.
      enter(cell, base);
      step_.blocked = true;
      return;
    }
    position_ = y;
    if (distance <= 1) return;
  }
}

/// Goes to the cell at `move`, whose components are -1, 0 or 1. When a link is missing, nothing
/// changes.
bool Traversal::switch_cell(const std::array<std::int64_t, 3>& move, const Vec3& y) noexcept {
  const int q =
      Direction::of(static_cast<int>(move[0]), static_cast<int>(move[1]), static_cast<int>(move[2]))
          .q();
  const auto base = static_cast<PointIndex>(base_ + grid_.neighbourhood().offset(q));
  if (!cross(q, base, y, step_)) return false;
  GridCoordinates cell;
  for (int a = 0; a < 3; ++a) cell[a] = static_cast<std::uint32_t>(cell_[a] + move[a]);
  enter(cell, base);
  const int axes = (move[0] != 0) + (move[1] != 0) + (move[2] != 0);
  ++(axes == 1 ? step_.face_switches : axes == 2 ? step_.edge_switches : step_.vertex_switches);
  step_.direction = static_cast<std::int8_t>(q);
  return true;
}

/// Takes the next other level of the grid point nearest to position().
void Traversal::choose_next() noexcept {
  const Vec3 in_cell = part();
  int nearest = 0;
  for (int a = 0; a < 3; ++a)
    if (in_cell[a] > 0.5) nearest |= 1 << a;
  const int levels = grid_.levels(cells_.point(base_, nearest));
  const Level present = level_at(nearest);
  for (int i = 1; i <= levels; ++i) {
    const auto level = static_cast<Level>((present == kNoLevel ? i - 1 : present + i) % levels);
    if (level == present || !begin(nearest, level)) continue;
    step_.chosen = level;
    step_.snapped = step_.level_changed = true;
    return;
  }
}

/// Whether corners changed in a step that ended outside the cell where it began. Without `split`
/// there was one switch at most, and a switch keeps the corners that both cells have.
void Traversal::compare_corners(const std::array<RecordIndex, 8>& before) noexcept {
  step_.corners_changed = false;
  if (step_.split) return;
  step_.nodes_before = before;
  for (int k = 0; k < 8; ++k) {
    if (step_.direction < 0) {
      step_.corners_changed |= nodes_[k] != before[k];
      continue;
    }
    const CellSwitch& table = kCellSwitches[step_.direction];
    if (table.direction[k] == CellSwitch::kKept)
      step_.corners_changed |= nodes_[k] != before[table.from[k]];
  }
}

void Traversal::enter(const GridCoordinates& cell, PointIndex base) noexcept {
  cell_ = cell;
  base_ = base;
  for (int a = 0; a < 3; ++a) {
    low_[a] = face(a, cell[a]);
    high_[a] = low_[a];
    if (cells_.is_flat(a)) continue;
    high_[a] = face(a, std::int64_t{cell[a]} + 1);
    const double width = high_[a] - low_[a];
    scale_[a] = 1 / width;
    if (width * scale_[a] < 1) scale_[a] = std::nextafter(scale_[a], kInfinity);
  }
}

std::array<double, 8> corner_weights(const Vec3& xbar) noexcept {
  const auto [x, y, z] = xbar;
  const double u = 1 - x, v = 1 - y, w = 1 - z;
  const double uv = u * v, xv = x * v, uy = u * y, xy = x * y;
  return {uv * w, xv * w, uy * w, xy * w, uv * z, xv * z, uy * z, xy * z};
}

void blend(const std::array<double, 8>& w, const std::array<const double*, 8>& rows,
           std::span<double> out) noexcept {
  const auto [s0, s1, s2, s3, s4, s5, s6, s7] = rows;
  const auto [w0, w1, w2, w3, w4, w5, w6, w7] = w;
  double* const o = out.data();
  const std::size_t n = out.size();
#ifndef __clang__  // clang does not know this pragma
#pragma GCC ivdep
#endif
  for (std::size_t i = 0; i < n; ++i)
    o[i] = ((w0 * s0[i] + w1 * s1[i]) + (w2 * s2[i] + w3 * s3[i])) +
           ((w4 * s4[i] + w5 * s5[i]) + (w6 * s6[i] + w7 * s7[i]));
}

}  // namespace hapgrid
