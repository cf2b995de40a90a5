// Whether play can interpolate the energy of a grid for its forces.
#pragma once

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/haptic/node_energies.hpp"

namespace hapgrid {

/// `gradient`, a note: how well the energies of neighbours on a branch predict the force of a
/// record (haptic/agreement.hpp). Counts the predictions. Figures: the force that was predicted,
/// and the errors of both predictions and their `ratio`, root mean squares. An offender is a grid
/// of which play does not take the energy.
/// @param fields of the grid, with energies.
Check check_gradient(const Grid& grid, const RecordFields& fields);

}  // namespace hapgrid
