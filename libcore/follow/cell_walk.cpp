#include "libcore/follow/cell_walk.hpp"

#include <cmath>
#include <limits>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::int64_t farthest(const std::array<std::int64_t, 3>& cells) {
  return std::max({std::abs(cells[0]), std::abs(cells[1]), std::abs(cells[2])});
}

}  // namespace

CellWalk::CellWalk(const Grid& grid, std::uint16_t most_parts)
    : grid_(grid), cells_(grid), box_(grid.box()), most_parts_(std::max<int>(most_parts, 1)) {
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

int CellWalk::nearest_corner() const noexcept {
  const Vec3 in_cell = part_of_cell(position_);
  int nearest = 0;
  for (int a = 0; a < 3; ++a)
    if (in_cell[a] > 0.5) nearest |= 1 << a;
  return nearest;
}

bool CellWalk::clamp(Vec3& x) const noexcept {
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

int CellWalk::begin(const Vec3& x) noexcept {
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
  base_ = box_.index(cell);
  for (int a = 0; a < 3; ++a) enter(a, cell[a]);
  position_ = x;
  is_split_ = is_lagging_ = false;
  return nearest;
}

/// The way leads out of the cell.
std::optional<CellWalk::Part> CellWalk::next_to_cell() noexcept {
  auto away = cells_away(aim_);
  const std::int64_t distance = farthest(away);
  Vec3 to = aim_;
  has_arrived_ = distance <= 1;
  is_split_ |= distance > 1;
  if (parts_++ == most_parts_) {
    has_arrived_ = is_lagging_ = true;
    return std::nullopt;
  }
  // The first of `distance` equal parts ends in a neighbouring cell, except for rounding. Then half
  // of that part is tried, and so on: position_ is in the cell, so some part is short enough.
  for (auto parts = static_cast<double>(distance); !has_arrived_; parts *= 2) {
    for (int a = 0; a < 3; ++a) to[a] = position_[a] + (aim_[a] - position_[a]) / parts;
    away = cells_away(to);
    if (farthest(away) <= 1) break;
  }
  if (farthest(away) == 0) return Part{to, base_, -1};
  const int q =
      Direction::of(static_cast<int>(away[0]), static_cast<int>(away[1]), static_cast<int>(away[2]))
          .q();
  return Part{to, static_cast<PointIndex>(base_ + grid_.neighbourhood().offset(q)), q};
}

void CellWalk::enter_from(const Part& part) noexcept {
  base_ = part.base;
  const auto move = Direction(part.q).step();
  for (int a = 0; a < 3; ++a)
    if (move[a] != 0) enter(a, cell_[a] + static_cast<std::uint32_t>(move[a]));
}

/// How many cells lie between the current cell and that of x along an axis. x is inside the box; a
/// coordinate on a face belongs to the nearer cell. The first guess is off by one at most when the
/// spacing is well above the rounding of coordinates; the loops end at the box in any case.
std::int64_t CellWalk::cells_away(int a, double x) const noexcept {
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

std::array<std::int64_t, 3> CellWalk::cells_away(const Vec3& x) const noexcept {
  return {cells_away(0, x[0]), cells_away(1, x[1]), cells_away(2, x[2])};
}

/// The cell is number c along an axis.
void CellWalk::enter(int a, std::uint32_t c) noexcept {
  cell_[a] = c;
  high_[a] = low_[a] = face(a, c);
  if (cells_.is_flat(a)) return;
  high_[a] = face(a, std::int64_t{c} + 1);
  const double width = high_[a] - low_[a];
  scale_[a] = 1 / width;
  if (width * scale_[a] < 1) scale_[a] = std::nextafter(scale_[a], kInfinity);
}

}  // namespace hapgrid
