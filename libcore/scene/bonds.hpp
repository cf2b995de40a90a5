// Finds the spheres of a picture that sticks join.
//
// A model's shape is a list of spheres without bonds. As in molecular viewers, two spheres are
// joined if they overlap deeply.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Pairs i < j of spheres whose distance is below 0.6 of the sum of their radii, ascending. With
/// van der Waals radii that tells bonds from neighbours of neighbours. There are none among more
/// than 4,096 spheres, because each frame compares all pairs. Source: the same rule and factor as
/// VMD's (User's Guide, "DynamicBonds" and "Bonds").
std::vector<std::array<std::uint32_t, 2>> find_bonds(const Scene& scene, const Frame& frame);

}  // namespace hapgrid
