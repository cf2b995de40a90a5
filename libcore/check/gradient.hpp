// Whether the force is the gradient of the energy, and play can interpolate the energy of a grid.
#pragma once

#include <span>

#include "libcore/check/report.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// `gradient`: how well the energies of neighbours on a branch predict the force of a record
/// (follow/record_fields.hpp). Counts the predictions. Figures: the force that was predicted, the
/// errors of both predictions as root mean squares, and their `ratio`.
///
/// The model, where it is at hand, is asked for the slope of its energy in some of `records`
/// (force_check.hpp): a fault where its force is another. Where the model is right and the grid
/// does not show it, a note with the spacing at which it would, found by asking the model, too.
/// Without a model, a note with an offender when play does not use the energy of this grid.
/// @param fields of the grid, with energies @param make_model empty: it is not at hand
Check check_gradient(const Grid& grid, const RecordFields& fields,
                     std::span<const RecordIndex> records, const MakeModel& make_model);

}  // namespace hapgrid
