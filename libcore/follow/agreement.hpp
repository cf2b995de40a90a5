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

  /// The prediction by energies is of fourth order in the spacing and that by forces of second, so
  /// the ratio of the errors goes to 0 as the grid gets finer, and any bound well below 0.5 will do:
  /// forces that are central differences of the energies have 0.5, whatever the energies are. Such a
  /// table is good where it is fine, and where forces are linear both errors are rounding. So an
  /// error that is small beside the force is good as well; an energy that is off by a fifth has 0.3
  /// of it.
  bool is_good() const {
    return predictions > 0 && (by_energy < 0.4 * by_forces || by_energy <= 0.05 * force);
  }
};

/// @param fields with energies
Agreement agreement(const Grid& grid, const RecordFields& fields);

}  // namespace hapgrid
