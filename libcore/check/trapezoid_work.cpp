#include "libcore/check/trapezoid_work.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// Forces come out of solvers; differences of this part of them are no gain.
constexpr double kNoise = 1e-9;

/// Where a link leads on the same branch: there and back; kNoRecord elsewhere.
RecordIndex along_branch(const Grid& grid, RecordIndex r, int q) {
  const RecordIndex target = grid.destination(r, q);
  if (target == Grid::kNoRecord) return target;
  return grid.destination(target, Direction(q).opposite().q()) == r ? target : Grid::kNoRecord;
}

}  // namespace

double TrapezoidWork::gain(const Link& link) const {
  const Vec3& d = grid_.neighbourhood().shift(link.q);
  const RecordIndex target = grid_.destination(link.from, link.q);
  return 0.5 * (dot(forces_[link.from], d) + dot(forces_[target], d));
}

double TrapezoidWork::bound(const Link& link) const {
  const Vec3& d = grid_.neighbourhood().shift(link.q);
  const int back = Direction(link.q).opposite().q();
  const RecordIndex target = grid_.destination(link.from, link.q);
  const RecordIndex before = along_branch(grid_, link.from, back);
  const RecordIndex after = along_branch(grid_, target, link.q);
  const double from = dot(forces_[link.from], d), to = dot(forces_[target], d);
  const double noise = kNoise * (std::abs(from) + std::abs(to));
  const auto change = [&](RecordIndex r, double other) {
    return r == Grid::kNoRecord ? 0 : std::abs(dot(forces_[r], d) - other);
  };
  if (!is_reversible(link))
    return noise + 0.5 * (std::abs(to - from) + change(before, from) + change(after, to));
  // F(before) - 2 F(from) + F(to), and the same about `to`.
  const double here = change(before, 2 * from - to), there = change(after, 2 * to - from);
  const bool has_before = before != Grid::kNoRecord, has_after = after != Grid::kNoRecord;
  if (has_before && has_after) return noise + 0.5 * std::max(here, there);
  if (has_before || has_after) return noise + std::max(here, there) + 0.5 * std::abs(to - from);
  return noise + 0.5 * (std::abs(from) + std::abs(to));
}

}  // namespace hapgrid
