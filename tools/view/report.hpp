// What view says of a stream of frames.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

struct SceneReport {
  using Range = std::pair<double, double>;  ///< the lowest and the highest value

  std::uint64_t frames = 0;
  double first_s = 0, last_s = 0;  ///< time of the first and last frame; without frames 0
  /// The box x y z that the spheres of all frames filled; empty without a sphere whose centre is
  /// finite.
  std::optional<std::array<Range, 3>> bounds;
  double largest_force = 0, largest_force_s = 0;  ///< newtons, of the magnitude, as sent
  std::optional<Range> energy;                    ///< of the frames whose energy is finite

  void add(const Scene& scene, const Frame& frame);
  /// Lines for people: times in s, forces in newtons, lengths and energies in the scene's units.
  std::string text(const Scene& scene) const;
};

}  // namespace hapgrid
