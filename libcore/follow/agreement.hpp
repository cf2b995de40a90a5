// Whether the force at a grid's records is the negated gradient of their energy.
//
// Each record's force along an axis is predicted from its two neighbours on the same branch, once
// by a Hermite polynomial from their energies and forces, once as the mean of their forces. If the
// force is the gradient of the energy, the first prediction is far better. The residual of energies
// against forces is no measure: it is larger on a good coarse grid than on a spoilt fine one.
#pragma once

#include <cstdint>

#include "libcore/follow/node_energies.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

struct Agreement {
  std::uint64_t predictions = 0;
  double force = 0;      ///< newtons, root mean square of the components that were predicted
  double by_energy = 0;  ///< newtons, root mean square of the error by energies and forces
  double by_forces = 0;  ///< newtons, the same of the mean of the forces

  /// Honest models have at most 0.36 of by_forces (17 grids, from 8 points a side on), spoilt ones
  /// at least 0.44 (32 of 34). But a table whose forces are central differences of its energies has
  /// 0.5, whatever it holds, and where forces are linear both errors are rounding. So a small error
  /// is good as well: an energy that is off by a fifth has 0.3 of the force.
  bool is_good() const {
    return predictions > 0 && (by_energy < 0.4 * by_forces || by_energy <= 0.05 * force);
  }
};

/// @param fields with energies
Agreement agreement(const Grid& grid, const RecordFields& fields);

}  // namespace hapgrid
