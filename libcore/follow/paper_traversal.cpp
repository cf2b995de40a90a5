#include "libcore/follow/paper_traversal.hpp"

namespace hapgrid {

const StepResult& PaperTraversal::start(const Vec3& hip, Level level) noexcept {
  const std::optional<int> nearest = begin_start(hip);
  if (!nearest) return step_;
  const bool has_begun = take(*nearest, level);
  if (has_begun) evaluate();
  return end_start(has_begun);
}

const StepResult& PaperTraversal::step(const Vec3& hip, bool next) noexcept {
  if (!has_started_) return start(hip, 0);
  if (!begin_step(hip)) return step_;
  while (const auto part = walk_.next()) {
    if (part->q >= 0 && !cross(*part)) {
      step_.blocked = true;
      break;
    }
    walk_.go(*part);
  }
  if (next && !step_.blocked) {
    const int corner = walk_.nearest_corner();
    choose_next(corner, levels_[corner], [&](Level level) { return take(corner, level); });
  }
  evaluate();
  return end_step();
}

/// The corner nearest to the HIP gets the level, the other seven its destination levels.
/// Source: Sect. 2.4. Deviation: level 0 in all corners, as printed, can mix branches.
bool PaperTraversal::take(int nearest, Level level) noexcept {
  const Cells& cells = walk_.cells();
  const PointIndex point = cells.point(walk_.base(), nearest);
  if (level >= grid_.levels(point)) return false;
  std::array<RecordIndex, 8> records;
  records.fill(grid_.first(point) + level);
  for (int k = 0; k < 8; ++k) {
    const int q = kBetweenCorners[nearest][cells.distinct(k)];
    if (q >= 0) records[k] = cells.destination(records[nearest], q, walk_.base(), k);
  }
  return set_corners(walk_.base(), records);
}

/// Sect. 2.4, i) to iii): a corner that both cells have keeps its record, the others get that to
/// which the link of kCellSwitches leads.
bool PaperTraversal::cross(const CellWalk::Part& part) noexcept {
  const CellSwitch& table = kCellSwitches[part.q];
  const std::array<Level, 8> before = levels_;
  std::array<RecordIndex, 8> records;
  for (int k = 0; k < 8; ++k) {
    const RecordIndex from = nodes_[table.from[k]];
    records[k] = table.direction[k] == CellSwitch::kKept
                     ? from
                     : walk_.cells().destination(from, table.direction[k], part.base, k);
  }
  if (!set_corners(part.base, records)) return false;
  for (int k = 0; k < 8; ++k) step_.level_changed |= levels_[k] != before[table.from[k]];
  count_switch(part);
  return true;
}

/// False when a link is missing: then nothing changes.
bool PaperTraversal::set_corners(PointIndex base,
                                 const std::array<RecordIndex, 8>& records) noexcept {
  for (const RecordIndex record : records)
    if (record == Grid::kNoRecord) return false;
  nodes_ = records;
  for (int k = 0; k < 8; ++k) {
    levels_[k] = static_cast<Level>(records[k] - grid_.first(walk_.cells().point(base, k)));
    rows_[k] = grid_.row(records[k]).data();
    // All rows are needed now; at the next switch the links, and where the next records begin.
    __builtin_prefetch(rows_[k]);
    __builtin_prefetch(rows_[k] + row_.size() - 1);
    __builtin_prefetch(grid_.links(records[k]).data());
    grid_.fetch_levels(walk_.cells().point(base, k) + (base - walk_.base()));
  }
  return true;
}

void PaperTraversal::evaluate() noexcept {
  const std::array<double, 8> weights = corner_weights(part());
  blend(weights, rows_, row_);
  if (!grid_.spec().equality.has_angles()) return;
  blend_angles(grid_.spec().equality, weights, rows_, row_);
  orthonormalise_rotations(grid_.spec().equality, row_);
}

}  // namespace hapgrid
