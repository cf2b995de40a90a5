#include "libcore/follow/model_traversal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

ModelTraversal::ModelTraversal(const Grid& grid, std::unique_ptr<Model> model, double steps_a_cell,
                               std::uint16_t most_parts)
    : Traversal(grid, most_parts),
      model_(std::move(model)),
      longest_(grid.box().spacing / steps_a_cell),
      next_(row_.size()),
      before_row_(row_.size()) {}

const StepResult& ModelTraversal::start(const Vec3& hip, Level level) noexcept {
  const std::optional<int> nearest = begin_start(hip);
  return nearest ? end_start(take(*nearest, level)) : step_;
}

const StepResult& ModelTraversal::step(const Vec3& hip, bool next) noexcept {
  if (!has_started_) return start(hip, 0);
  if (!begin_step(hip)) return step_;
  while (const auto part = walk_.next()) {
    before_row_ = row_;
    if (!follow(position(), part->to)) {
      step_.blocked = true;
      break;
    }
    walk_.go(*part);
    count_switch(*part);
  }
  if (next && !step_.blocked) {
    const int corner = walk_.nearest_corner();
    choose_next(corner, level_at(corner), [&](Level level) { return take(corner, level); });
  }
  return end_step();
}

/// The level of the corner nearest to the HIP, and C from there to the HIP.
bool ModelTraversal::take(int nearest, Level level) noexcept {
  const PointIndex p = walk_.cells().point(walk_.base(), nearest);
  if (level >= grid_.levels(p)) return false;
  before_row_ = row_;
  const std::span<const double> row = grid_.row(grid_.first(p) + level);
  std::copy(row.begin(), row.end(), row_.begin());
  return follow(grid_.box().position(p), position());
}

/// The level whose state is nearest to the present one.
Level ModelTraversal::level_at(int corner) const noexcept {
  const PointIndex p = walk_.cells().point(walk_.base(), corner);
  Level nearest = kNoLevel;
  double least = std::numeric_limits<double>::infinity();
  for (RecordIndex level = 0; level < grid_.levels(p); ++level) {
    const double away = distance(grid_.spec().equality, grid_.state_size(), row_.data(),
                                 grid_.row(grid_.first(p) + level).data());
    if (away >= least) continue;
    least = away;
    nearest = static_cast<Level>(level);
  }
  return nearest;
}

bool ModelTraversal::look_ahead(const Vec3& x, std::span<double> row) noexcept {
  before_row_ = row_;
  if (!follow(position(), x)) return false;
  std::copy_n(row_.begin(), row.size(), row.begin());
  row_ = before_row_;
  return true;
}

/// Whole or not at all: when a conversion fails, the state is before_row_ again.
bool ModelTraversal::follow(Vec3 from, const Vec3& to) noexcept {
  const Vec3 way = to - from;
  const double length = std::hypot(way[0], way[1], way[2]);
  if (length == 0) return true;
  const double steps = std::ceil(length / longest_);
  const Vec3 d{way[0] / steps, way[1] / steps, way[2] / steps};
  for (double i = 0; i < steps; ++i) {
    for (int a = 0; a < 3; ++a) from[a] = to[a] - (steps - i) * d[a];
    if (!model_->convert(row_.data(), from, d, next_.data())) {
      row_ = before_row_;
      return false;
    }
    row_.swap(next_);
  }
  return true;
}

}  // namespace hapgrid
