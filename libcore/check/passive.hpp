// Whether a hand that comes back to where it was can have gained energy.
//
// Where play interpolates the energy of the nodes (haptic/node_force.hpp), this energy is the
// potential of the force on a branch, so that a closed walk on a branch has no work at all. What is
// left is where the state snaps to another branch: the hand gains what the energy behind the snap
// is above the energy before it, and no closed walk gains anything when no snap leads up. Each snap
// along an axis is looked at by itself, which is the whole proof.
//
// Behind its end a branch is extrapolated, up to where the tear function is 0. Half of what the
// energies at the snap go beyond the slopes of the two records is allowed, because it was
// extrapolated. So is what the friction of a device takes: 0.2 N along two spacings.
#pragma once

#include <string>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/node_energies.hpp"

namespace hapgrid {

/// `passive`: no snap leads up, and all energies and forces are finite numbers. Counts the links
/// along the axes. Figures, in newtons times the unit of length: `largest gain`, what a snap leads
/// up beyond what was extrapolated, and `largest loss`, what one leads down: the hysteresis.
/// @param nodes with the ghosts of map.nodes
Check check_passive(const Grid& grid, const BranchMap& map, const NodeEnergies& nodes);

/// `passive` where play takes its force from elsewhere: not proved.
/// @param why and what to do
Check passive_not_proved(std::string why);

}  // namespace hapgrid
