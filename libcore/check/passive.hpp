// What play does with the hand's energy: closed walks along links (energy.hpp), and how much more
// the blending of branches can return.
#pragma once

#include "libcore/check/configurations.hpp"
#include "libcore/check/energy.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/check/played_work.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `passive`: no closed walk along links gains more energy than is tolerated, and all work is
/// finite. Counts links; those that lead nowhere are left to `links`. Figures:
///
/// `gain per length`, newtons: what the steepest closed walk gains beyond its allowances, divided
/// by its length. Its links are beside it.
///
/// `largest loss`, newtons times the unit of length: what a one-way link and the reversible way
/// back cost: the hysteresis.
/// @param energy find_energy() of this work
Check check_passive(const Grid& grid, const Work& work, const Energy& energy);

/// Figures of `passive` for the paper's rule of traversal, in newtons times the unit of length:
///
/// `largest turn`: what one turn around a face of a cell returns in one of its directions, over all
/// configurations of play. Exact for a stored force.
///
/// `largest mixture`: how far the energies of two branches are apart at a point where a mixed
/// configuration (paths.hpp) has one and a corner's link leads to the other. Walks along links
/// never cross between branches without a link; a hand can, inside a mixed cell, where the force is
/// a blend. As cell switches carry a mixture along, a closed walk of the hand that crosses there
/// and back where the branches are differently far apart can return up to this, beside what the
/// crossing costs. It is a property of Algorithm 2 and no fault of the grid.
/// @param threads at least 1; the result does not depend on it.
void add_inside_cells(Check& check, const Grid& grid, const CellMap& map,
                      const Configurations& found, const Forces& forces, const Energy& energy,
                      int threads);

/// `limited`, a note: what the limit of the force does to this. A force that is cut to a length and
/// keeps its direction is no gradient any more, even if it was one.
/// @param energy find_energy() of the work of the force so limited
Check check_limited(const Grid& grid, const ForceLimit& limit, const Energy& energy);

}  // namespace hapgrid
