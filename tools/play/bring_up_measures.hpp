// What the bring-up of a device computes from what it has recorded. Nothing here talks to a device.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

/// The step in which positions come, in metres; 0 where none changes. Most changes between two
/// ticks of a hand that moves slowly are one step or none. The largest of the three axes counts.
double encoder_step(std::span<const Vec3> positions);

/// From the lowest to the highest position of a handle at rest, on the worst axis, in metres.
double noise_of(std::span<const Vec3> positions);

/// The pattern by which a device is shaken: +1 or -1 for each tick, and after these from the start.
inline constexpr std::size_t kShakeTicks = 512;
double shake(std::uint64_t tick) noexcept;

/// The force along one axis and the position on it, as means over repetitions of the pattern.
class Shaken {
 public:
  void add(std::uint64_t tick, double force, double position);
  double force(std::size_t tick) const noexcept;
  double position(std::size_t tick) const noexcept;

 private:
  struct Sum {
    double force = 0, position = 0, count = 0;
  };
  std::vector<Sum> sums_{kShakeTicks};
};

/// In how many ticks a force acts, as safety.delay counts them: 0 for a device whose adapter
/// applies a force before it measures the position that it answers. Nothing where the handle did
/// not follow the force clearly enough.
///
/// Problem. Handle and hand are a mass on a spring and a damper, which nobody knows, and which
/// follow a force much later than it acts. Encoder and tremor hide the beginning of a motion.
/// Choice: m x'' + b x' + k x = F(t - delay) + constant holds at all times, so it is fitted in its
/// weak form, integrated with a smooth window w that ends in zeros, where derivatives of x become
/// those of w: no measured position is differentiated. The delay with the smallest residual counts.
/// Alternatives: the time of the first step that is seen (late by 10 ms and more for a coarse
/// encoder); the phase between force and motion (that of mass, spring and damper is part of it).
std::optional<std::uint32_t> delay_of(std::span<const Shaken> axes);

}  // namespace hapgrid
