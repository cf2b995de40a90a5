// The force of the rule of branches: from the energies of a grid's records, or where these do not
// say it, from the forces of the records.
#pragma once

#include <memory>
#include <string>

#include "libcore/follow/node_force.hpp"

namespace hapgrid {

/// What NodeForce needs.
struct NodeForces {
  std::shared_ptr<NodeEnergies> nodes;  ///< of the records; add_ghosts() is the caller's
  std::string why_not;  ///< why the force is not the gradient of the energy; empty: it is
  std::string remark;   ///< what is odd about an energy that is taken; else empty

  bool has_energy() const { return why_not.empty(); }
  NodeForce::Interpolate interpolate() const { return has_energy() ? hermite_force : mean_force; }
};
/// @param fields of the grid
NodeForces node_forces(const Grid& grid, const RecordFields& fields);

}  // namespace hapgrid
