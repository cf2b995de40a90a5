// A hand that moves at random: it goes straight for a while, turns, and is reflected at the sides
// of the box.
#pragma once

#include <cstdint>

#include "libcore/base/random.hpp"
#include "libcore/grid/box.hpp"

namespace hapgrid {

class RandomHand {
 public:
  /// @param box outlives the hand. @param steps that it makes in a leg, from one place to the next:
  /// half a spacing or less.
  RandomHand(const Box& box, std::uint64_t seed, int steps)
      : box_(box), random_(seed), steps_(steps) {}

  /// To any point of the grid.
  PointIndex jump();
  const Vec3& at() const { return at_; }
  void put(const Vec3& x) { at_ = x; }
  /// Before each leg: may turn.
  void set_out();
  void step();

 private:
  void turn();

  const Box& box_;
  SplitMix64 random_;
  int steps_;
  Vec3 at_{0, 0, 0};
  Vec3 towards_{0, 0, 0};
  double length_ = 0;       // of a step
  std::uint64_t left_ = 0;  // legs before it turns
};

}  // namespace hapgrid
