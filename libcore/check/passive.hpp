// Whether a hand that comes back to where it was can have gained energy.
//
// Where play interpolates the energy of the nodes (follow/node_force.hpp), this energy is the
// potential of the force on a branch, so that a closed walk on a branch has no work at all. What is
// left is where the state snaps to another branch: the hand gains what the energy behind the snap
// is above the energy before it, and no closed walk gains anything when no snap leads up. Each snap
// along an axis is looked at by itself, which is the whole proof.
//
// Behind its end a branch is extrapolated, up to where the model snaps. Half of what the
// energies at the snap go beyond the slopes of the two records is allowed, because it was
// extrapolated. So is what the friction of a device takes: 0.2 N along two spacings.
//
// The snap can be anywhere on its link, wherever the model beside the grid says that it is. So the
// energies are compared at places all along the link. Few links have places where the snap would
// lead up and others where it would not: the model is asked for those alone.
#pragma once

#include <string>

#include "libcore/check/report.hpp"
#include "libcore/follow/branch_nodes.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// `passive`: no snap leads up, and all energies and forces are finite numbers. Counts the links
/// along the axes. Figures, in newtons times the unit of length: `largest gain`, what a snap leads
/// up beyond what was extrapolated, and `largest loss`, what one leads down: the hysteresis.
/// Not proved where the places of snaps decide, and nobody knows them.
/// @param nodes with the ghosts of `branches`
/// @param make_model makes the models that find the places of snaps, one for each thread, in the
/// calling thread; empty: there is none. A conversion that fails is an offender.
Check check_passive(const Grid& grid, const BranchNodes& branches, const NodeEnergies& nodes,
                    const MakeModel& make_model = {}, int threads = 1);

/// `passive` where play takes its force from elsewhere: not proved.
/// @param why and what to do
Check passive_not_proved(std::string why);

}  // namespace hapgrid
