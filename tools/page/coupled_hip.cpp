#include "tools/page/coupled_hip.hpp"

#include <algorithm>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// After a hiccup of the machine the force is old: the HIP does not go far with it.
constexpr double kLongestTick = 0.004;

}  // namespace

std::pair<Vec3, Vec3> hand_range(const Box& box) {
  const HipRange range{
      .low = box.position({0, 0, 0}),
      .high = box.position({box.counts[0] - 1, box.counts[1] - 1, box.counts[2] - 1})};
  const double reach = kHandReach * range.longest_side();
  const Vec3 margin{reach, reach, reach};
  return {range.low - margin, range.high + margin};
}

CoupledHip::CoupledHip(const HipRange& range)
    : range_(range),
      speed_(kHandSpeed * range.longest_side()),
      stiffness_(kHandForce / (kHandReach * range.longest_side())),
      x_(range.start) {}

const Vec3& CoupledHip::next(const Vec3& hand, const Vec3& force, double dt) noexcept {
  const double tick = std::clamp(dt, 0.0, kLongestTick);
  const double part = tick / (kHandSeconds + tick);
  // A hand far away pulls no more than one that the HIP can be drawn behind.
  const double margin = kHandReach * range_.longest_side();
  Vec3 way;
  for (int a = 0; a < 3; ++a) {
    const double h = std::clamp(hand[a], range_.low[a] - margin, range_.high[a] + margin);
    way[a] = part * (h + force[a] / stiffness_ - x_[a]);
  }
  const double length = length_of(way);
  const double most = speed_ * tick;
  const double shown = length > most ? most / length : 1;
  for (int a = 0; a < 3; ++a)
    x_[a] = std::clamp(x_[a] + shown * way[a], range_.low[a], range_.high[a]);
  return x_;
}

}  // namespace hapgrid
