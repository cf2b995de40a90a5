// The light in a picture, for the two that draw it: render() and view's page. A ball's neighbours
// take light from it by a closed form, so that a picture needs no noise and has the same bytes
// everywhere.
#pragma once

#include <cstddef>

#include "libcore/grid/vec3.hpp"
#include "libcore/scene/drawing.hpp"

namespace hapgrid::light {

// Directions in the picture: x right, y down, z to the viewer.
inline constexpr Vec3 kFrom{-0.4243, -0.5657, 0.7071};     ///< from the upper left
inline constexpr Vec3 kHalfWay{-0.2297, -0.3062, 0.9239};  ///< between the light and the viewer
inline constexpr double kAmbient = 0.44, kDiffuse = 0.52, kShine = 0.45;
inline constexpr double kFog = 0.35;           ///< of white, at the back
inline constexpr double kOutlineDepth = 0.35;  ///< of a radius: what lies deeper gets a dark rim
inline constexpr double kOutlineLight = 0.25;
inline constexpr double kFloor = 0.97;
inline constexpr double kShadow = 0.24;  ///< what the darkest shadow takes of the floor's light
inline constexpr double kReach = 4;      ///< radii within which a sphere darkens others
inline constexpr std::size_t kMostOccluders = 16;
/// Each pair of spheres is looked at: with more of them none darkens another.
inline constexpr std::size_t kMostShaded = 4096;
// The light on a point is kOpen exp(-kFading s), held between the others; s is what its neighbours
// cover of the sky above it.
inline constexpr double kOpen = 1.45, kFading = 0.33, kLeastOpen = 0.12, kMostOpen = 1.05;

}  // namespace hapgrid::light
