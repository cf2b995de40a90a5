// The search for one tear fraction (tears.hpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libcore/grid/state_distance.hpp"
#include "libcore/grid/tear.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// It asks for one conversion at a time, so that those of other bisections can be under way
/// meanwhile.
class Bisection {
 public:
  explicit Bisection(std::size_t row_size) : middle_row_(row_size), back_row_(row_size) {}

  /// @param index the number that the caller gives it
  /// @param x where the HIP is in the state of `from`; it moves by d to where `to` is reached
  void start(std::size_t index, const Vec3& x, const Vec3& d, std::span<const double> from,
             std::span<const double> to) {
    index_ = index;
    x_ = x;
    d_ = d;
    low_ = 0;
    high_ = kTearSteps;
    is_back_ = false;
    low_row_.assign(from.begin(), from.end());
    high_row_.assign(to.begin(), to.end());
  }

  std::size_t index() const { return index_; }
  /// The conversion to be made, into a row of this object.
  Conversion conversion(std::uint64_t tag) {
    if (is_back_)
      return {middle_row_.data(), at(middle()), shift(low_ - middle()), back_row_.data(), tag};
    return {low_row_.data(), at(low_), shift(middle() - low_), middle_row_.data(), tag};
  }

  /// Goes on with the row that the conversion reached. Answers whether the fraction is found.
  bool advance(StateDistance& distance) {
    if (is_back_) {
      halve(distance.is_same(back_row_, low_row_));
    } else {
      is_back_ = true;
      if (high_ - low_ == kTearSteps) return false;
      const double from_low = distance(middle_row_, low_row_);
      const double from_high = distance(middle_row_, high_row_);
      const bool is_low = from_low < from_high;
      if (!(kNearer * std::min(from_low, from_high) <= std::max(from_low, from_high)) ||
          from_low == from_high)
        return false;
      halve(is_low);
    }
    is_back_ = false;
    return high_ - low_ == 1;
  }
  TearByte tear() const { return static_cast<TearByte>(low_); }

 private:
  static constexpr double kNearer = 4;

  int middle() const { return (low_ + high_) / 2; }
  Vec3 shift(int steps) const {
    const double part = static_cast<double>(steps) / kTearSteps;
    return {part * d_[0], part * d_[1], part * d_[2]};
  }
  Vec3 at(int step) const {
    const Vec3 d = shift(step);
    return {x_[0] + d[0], x_[1] + d[1], x_[2] + d[2]};
  }
  void halve(bool is_on_branch) {
    (is_on_branch ? low_ : high_) = middle();
    std::swap(middle_row_, is_on_branch ? low_row_ : high_row_);
  }

  std::size_t index_ = 0;
  Vec3 x_{};
  Vec3 d_{};
  int low_ = 0;  // the model snaps between these steps, and these are its states there
  int high_ = kTearSteps;
  std::vector<double> low_row_;
  std::vector<double> high_row_;
  std::vector<double> middle_row_;
  std::vector<double> back_row_;
  bool is_back_ = false;  // goes back from the middle to low_
};

}  // namespace hapgrid
