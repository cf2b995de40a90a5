// Keeps a state or a force from jumping where the traversal changes corners without a snap: the
// difference at the place of the change is added to it, and fades while the hand moves on by half a
// spacing.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

/// Everything but the constructor is real-time safe.
class FadingOffset {
 public:
  /// @param size how many numbers it has. @param spacing of the grid
  FadingOffset(std::size_t size, double spacing) : values_(size), way_(spacing / 2) {}

  bool any() const { return left_ > 0; }
  void end() noexcept { left_ = 0; }
  /// Begins to fade anew. @returns the numbers, to which the caller adds a difference
  std::span<double> renew() noexcept {
    if (!any()) std::fill(values_.begin(), values_.end(), 0.0);
    left_ = way_;
    return values_;
  }
  /// The hand moves from one place to another.
  void fade(const Vec3& from, const Vec3& to) noexcept {
    if (!any()) return;
    const double moved = length_of(to - from);
    if (moved >= left_) return end();
    const double part = 1 - moved / left_;
    for (double& value : values_) value *= part;
    left_ -= moved;
  }
  /// @param out as many numbers
  void add_to(std::span<double> out) const noexcept {
    if (!any()) return;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += values_[i];
  }

 private:
  std::vector<double> values_;
  double way_;
  double left_ = 0;  // of the way on which it fades
};

}  // namespace hapgrid
