// The rules for the force that --force can name, and which of them a grid can have.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "libcore/follow/node_force.hpp"
#include "tools/common/traversals.hpp"

namespace hapgrid {

enum class ForceRule {
  kEnergy,   ///< the gradient of the interpolated energy
  kRecords,  ///< the forces of the records, interpolated
  kState     ///< as the paper has it: the force of the interpolated state, or the stored one
};

const char* name_of(ForceRule rule);
/// Nothing when no rule has that name.
std::optional<ForceRule> force_named(const std::string& name);

/// What is asked where nothing is: kEnergy for the rule of branches, kState for the others.
ForceRule default_force(TraversalRule traversal);

/// What NodeForce needs, for kEnergy or kRecords.
struct NodeForces {
  ForceRule rule;
  std::string why_not;  ///< why it is not kEnergy, though that was asked; else empty
  std::string remark;   ///< what is odd about an energy that is taken; else empty
  std::shared_ptr<NodeEnergies> nodes;  ///< of the records; add_ghosts() is the caller's
  NodeForce::Interpolate interpolate;
};
/// @param wanted kEnergy or kRecords; the second is taken where no energy has the forces as its
/// gradient. @param fields of the grid
NodeForces node_forces(ForceRule wanted, const Grid& grid, const RecordFields& fields);

}  // namespace hapgrid
