#include "libcore/follow/traversal.hpp"

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

std::array<RecordIndex, 8> Traversal::records() const noexcept {
  std::array<RecordIndex, 8> records = nodes_;
  for (RecordIndex& record : records)
    if (record >= grid_.records()) record = Grid::kNoRecord;
  return records;
}

std::array<Level, 8> Traversal::levels() const noexcept {
  std::array<Level, 8> levels;
  for (int k = 0; k < 8; ++k)
    levels[k] = nodes_[k] < grid_.records() ? grid_.level(nodes_[k]) : kNoLevel;
  return levels;
}

std::optional<int> Traversal::begin_start(const Vec3& hip) noexcept {
  step_ = {.started = true};
  before_.keep(position(), nodes_);
  has_started_ = false;
  ++jumps_;
  if (!finite(hip)) {
    step_.not_finite = true;
    return std::nullopt;
  }
  Vec3 x = hip;
  step_.outside = walk_.clamp(x);
  return walk_.begin(x);
}

const StepResult& Traversal::end_start(bool has_begun) noexcept {
  has_started_ = has_begun;
  step_.blocked = !has_begun;
  if (!has_begun) walk_.give_up(before_.from);
  return step_;
}

bool Traversal::begin_step(const Vec3& hip) noexcept {
  step_ = {};
  before_.keep(position(), nodes_);
  if (walk_.has(hip)) {  // the most frequent case: it is finite and in the box
    walk_.aim_in_cell(hip);
    return true;
  }
  if (!finite(hip)) {
    step_.not_finite = true;
    return false;
  }
  Vec3 x = hip;
  step_.outside = walk_.clamp(x);
  walk_.aim(x);
  return true;
}

void Traversal::count_switch(const CellWalk::Part& part) noexcept {
  if (part.q < 0) return;
  const auto move = Direction(part.q).step();
  const int axes = (move[0] != 0) + (move[1] != 0) + (move[2] != 0);
  ++(axes == 1 ? step_.face_switches : axes == 2 ? step_.edge_switches : step_.vertex_switches);
  before_.direction = static_cast<std::int8_t>(part.q);
}

/// Without `split` there was one switch at most, and a switch keeps the corners that both cells
/// have.
const StepResult& Traversal::end_step() noexcept {
  step_.split = walk_.is_split();
  step_.lagging = walk_.is_lagging();
  jumps_ += step_.snapped;
  if (step_.split) return step_;
  if (before_.direction < 0) {
    RecordIndex changed = 0;
    for (int k = 0; k < 8; ++k) changed |= nodes_[k] ^ before_.nodes[k];
    before_.have_changed = changed != 0;
    return step_;
  }
  const CellSwitch& table = kCellSwitches[before_.direction];
  for (int k = 0; k < 8; ++k)
    before_.have_changed |= static_cast<bool>(int{table.direction[k] == CellSwitch::kKept} &
                                              int{nodes_[k] != before_.nodes[table.from[k]]});
  return step_;
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
