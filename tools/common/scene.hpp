// The scene of a grid's model: what is the same in all its pictures.
#pragma once

#include "libcore/model/fields.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// @param fields that have the shape. What only a play knows, its keys and largest force, is left
/// out.
inline Scene scene_of(const GridSpec& spec, const Fields& fields) {
  return {.model = spec.model,
          .length_unit = spec.length_unit,
          .energy_unit = spec.energy_unit,
          .box = spec.box,
          .state_size = spec.state_size,
          .hip_radius = spec.hip_radius,
          .spheres = fields.spheres(),
          .torsions = fields.torsions(),
          .keys = {}};
}

}  // namespace hapgrid
