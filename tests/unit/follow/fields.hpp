// Energies and forces of a grid that are known functions of the place.
#pragma once

#include "libcore/follow/record_fields.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid::testing {

/// Energy and force at the records of a grid, from functions of the place.
template <class Energy, class Force>
RecordFields fields_of(const Grid& grid, Energy&& energy, Force&& force) {
  RecordFields fields;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    const Vec3 x = grid.box().position(grid.point(r));
    fields.energy.push_back(energy(x));
    fields.force.push_back(force(x));
  }
  return fields;
}

}  // namespace hapgrid::testing
