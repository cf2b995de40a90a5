#include "tools/page/coupled_hip.hpp"

#include <algorithm>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// After a hiccup of the machine the force is old: the HIP does not go far with it.
constexpr double kLongestTick = 0.004;

}  // namespace

std::pair<Vec3, Vec3> hand_range(const Box& box) {
  const double reach = kHandReach * box.longest_side();
  const Vec3 margin{reach, reach, reach};
  return {box.origin - margin, box.high() + margin};
}

CoupledHip::CoupledHip(const Box& box, const Vec3& start)
    : box_(box),
      speed_(kHandSpeed * box.longest_side()),
      stiffness_(kHandForce / (kHandReach * box.longest_side())),
      x_(start) {}

const Vec3& CoupledHip::next(const Vec3& hand, const Vec3& force, double dt) noexcept {
  const double tick = std::clamp(dt, 0.0, kLongestTick);
  const double part = tick / (kHandSeconds + tick);
  // A hand far away pulls no more than one that the HIP can be drawn behind.
  const double margin = kHandReach * box_.longest_side();
  const Vec3 low = box_.origin, high = box_.high();
  Vec3 way;
  for (int a = 0; a < 3; ++a) {
    const double h = std::clamp(hand[a], low[a] - margin, high[a] + margin);
    way[a] = part * (h + force[a] / stiffness_ - x_[a]);
  }
  const double length = length_of(way);
  const double most = speed_ * tick;
  const double shown = length > most ? most / length : 1;
  for (int a = 0; a < 3; ++a) x_[a] = std::clamp(x_[a] + shown * way[a], low[a], high[a]);
  return x_;
}

}  // namespace hapgrid
