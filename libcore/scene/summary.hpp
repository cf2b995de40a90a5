// What happened in a stream of frames.
#pragma once

#include <cstdint>
#include <optional>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

struct SceneSummary {
  struct Range {
    double low;
    double high;
  };

  std::uint64_t frames = 0;
  double first_s = 0;  ///< time of the first and last frame; without frames 0
  double last_s = 0;
  /// The box x y z that the spheres of all frames filled; empty without a sphere in a finite place.
  std::optional<std::array<Range, 3>> bounds;
  double largest_force = 0;  ///< newtons, of the magnitude, as sent
  double largest_force_s = 0;
  std::optional<Range> energy;  ///< of finite ones

  void add(const Scene& scene, const Frame& frame);
};

}  // namespace hapgrid
