#include "libcore/haptic/paper_traversal.hpp"

namespace hapgrid {

bool PaperTraversal::begin(int nearest, Level level) noexcept {
  Corners corners;
  if (!cells_.start(base(), nearest, corners, level)) return false;
  set_corners(corners);
  return true;
}

bool PaperTraversal::cross(int q, PointIndex base, const Vec3&, StepResult& result) noexcept {
  Corners corners;
  bool changed = false;
  if (!cells_.cross(q, base, {records_, levels_}, corners, changed)) return false;
  set_corners(corners);
  result.level_changed |= changed;
  return true;
}

void PaperTraversal::set_corners(const Corners& corners) noexcept {
  records_ = nodes_ = corners.record;
  levels_ = corners.level;
  for (int corner = 0; corner < 8; ++corner) {
    rows_[corner] = grid_.row(records_[corner]).data();
    // All rows are needed now, the links at the next switch.
    const Level* const links = grid_.links(records_[corner]).data();
    __builtin_prefetch(rows_[corner]);
    __builtin_prefetch(rows_[corner] + row_.size() - 1);
    __builtin_prefetch(links);
    __builtin_prefetch(links + kDirections - 1);
  }
}

void PaperTraversal::evaluate() noexcept {
  const std::array<double, 8> weights = corner_weights(part_of_cell(position()));
  blend(weights, rows_, row_);
  blend_angles(grid_.spec().equality, weights, rows_, row_);
  orthonormalise_rotations(grid_.spec().equality, row_);
}

}  // namespace hapgrid
