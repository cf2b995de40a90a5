// Whether play can interpolate the energy of a grid for its forces.
#pragma once

#include "libcore/check/report.hpp"
#include "libcore/follow/node_energies.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `gradient`, a note: how well the energies of neighbours on a branch predict the force of a
/// record (follow/agreement.hpp). Counts the predictions. Figures: the force that was predicted,
/// the errors of both predictions as root mean squares, and their `ratio`. The check has an
/// offender when play does not use the energy of this grid.
/// @param fields of the grid, with energies.
Check check_gradient(const Grid& grid, const RecordFields& fields);

}  // namespace hapgrid
