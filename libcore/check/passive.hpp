// What play does with the hand's energy: closed walks along links (energy.hpp), and how much more
// the blending of branches can return.
#pragma once

#include "libcore/check/configurations.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `passive`: no closed walk along links gains more energy than the spacing explains. Counts links;
/// those that lead nowhere are left to `links`. Figures, in newtons times the unit of length:
///
/// `largest loss`: what a one-way link and the reversible way back cost: the hysteresis.
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
///
/// @param threads at least 1; the result does not depend on it.
Check check_passive(const Grid& grid, const CellMap& map, const Configurations& found,
                    const Forces& forces, int threads);

}  // namespace hapgrid
