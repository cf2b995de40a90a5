// A hand without a force on it, such as one on a mouse.
//
// Pseudo-haptics (Lécuyer 2009 is the survey): the picture moves less than the hand where the force
// is against it, and people take that for resistance. Here the HIP itself does so, by the
// virtual coupling of Colgate, Stanley and Brown (1995) without a mass: a spring k and a damper b
// from the hand's place h to the HIP at x, on which the force F of the grid acts,
//
//   b x' = k (h - x) + F.
//
// At rest the HIP lags behind the hand by |F| / k. In a wall of stiffness K it makes k / (k + K) of
// the hand's motion. When the model snaps, so that F is gone, it goes to the hand with the time
// constant b / k, which also smooths positions that come only 60 to 125 times a second.
//
// The page that plays a grid by itself computes the coupling in each tick. With the
// force of the tick before, a tick dt moves the HIP the part dt / (b / k + dt) of the way to h + F
// / k. So the HIP does not swing while K <= k (b / k) / dt = b / dt: at 1 kHz behind walls of up to
// 30 k. A steeper wall can shake it, by no more than the safety core's guard against buzzing
// allows. Between ticks only x is kept, and x is the position that a session records: it can be
// replayed like any other.
#pragma once

#include <utility>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// How far the HIP lags behind the hand when the force is kHandForce newtons, in longest sides of
/// the box.
inline constexpr double kHandReach = 1.0 / 3;
inline constexpr double kHandForce = 3;
/// The HIP crosses so many longest sides of the box in a second at most.
inline constexpr double kHandSpeed = 4;
/// Time constant with which the HIP follows the hand, in seconds.
inline constexpr double kHandSeconds = 0.03;

/// The lowest and the highest place of a hand: as far outside the box as the HIP can lag behind it.
std::pair<Vec3, Vec3> hand_range(const Box& box);

/// The HIP on its spring. Real-time safe.
class CoupledHip {
 public:
  /// @param box that the HIP does not leave. @param start where it begins
  CoupledHip(const Box& box, const Vec3& start);

  /// The HIP `dt` seconds later; more than 4 ms count as 4 ms. @param hand, force finite; newtons.
  const Vec3& next(const Vec3& hand, const Vec3& force, double dt) noexcept;
  /// The stiffness k of the spring, in newtons per unit of the model's length.
  double stiffness() const { return stiffness_; }

 private:
  Box box_;
  double speed_;  // units a second
  double stiffness_;
  Vec3 x_;
};

}  // namespace hapgrid
