// Which spheres of a picture are joined by sticks.
//
// Nothing tells of bonds: a model's shape is spheres in places. What molecular viewers do without
// a list of bonds is done here: two spheres are joined where they overlap deeply.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Pairs i < j of spheres in finite places whose distance is below 0.6 of the sum of their radii,
/// ascending. With van der Waals radii that tells bonds from neighbours of neighbours. None for
/// more than 4,096 spheres: all pairs are looked at in each frame.
/// Source: the same rule and factor as VMD's (User's Guide, "DynamicBonds" and "Bonds").
std::vector<std::array<std::uint32_t, 2>> find_bonds(const Scene& scene, const Frame& frame);

}  // namespace hapgrid
