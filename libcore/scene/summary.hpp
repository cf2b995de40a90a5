// The figures of a stream of frames for a report.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

struct SceneSummary {
  using Range = std::pair<double, double>;  ///< the lowest and the highest value

  std::uint64_t frames = 0;
  double first_s = 0;  ///< time of the first and last frame; without frames 0
  double last_s = 0;
  /// The box x y z that the spheres of all frames filled; empty without a sphere whose centre is
  /// finite.
  std::optional<std::array<Range, 3>> bounds;
  double largest_force = 0;  ///< newtons, of the magnitude, as sent
  double largest_force_s = 0;
  std::optional<Range> energy;  ///< of the frames whose energy is finite

  void add(const Scene& scene, const Frame& frame);
};

}  // namespace hapgrid
