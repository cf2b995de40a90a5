// Keeps a state or a force from jumping where the traversal changes corners without a snap: the
// difference at the place of the change is added to it, and fades while the hand moves on by half a
// spacing.
//
// Where the model walks beside the grid (beside.hpp), what the interpolation lacks to the model's
// state and force is added, too. This difference is *held*: it does not fade until the model's
// answers fail to come.
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
