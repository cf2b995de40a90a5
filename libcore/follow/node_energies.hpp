// The energy at the nodes of a grid and its derivatives, from which play interpolates the force
// (node_force.hpp).
#pragma once

#include <array>
#include <vector>

#include "libcore/follow/branch_nodes.hpp"
#include "libcore/follow/record_fields.hpp"

namespace hapgrid {

/// The energy at a node and its derivatives, all in newtons because lengths are in spacings.
struct NodeEnergy {
  float energy = 0;              ///< above an energy that all nodes have in common
  std::array<float, 3> slope{};  ///< of the energy along x, y, z: the force, negated
  std::array<float, 3> mixed{};  ///< mixed second derivatives: of yz, xz, xy
};

/// By node, the records first. Each node has an entry of 28 bytes.
///
/// The energy of a state at rest is smooth on a branch, and its gradient there is the negated
/// force, so energy and slope are known exactly. The mixed derivatives are differences of the
/// slopes along two-way links. A ghost has what its branch would have at its point: slopes are
/// extrapolated linearly, and the energy is that of the records beside it and the mean slope on the
/// way. It is at least that of the records to which the links lead, since no model snaps to a state
/// of more energy: else a hand that goes in a circle through the snap would gain energy.
class NodeEnergies {
 public:
  /// Of the records alone.
  NodeEnergies(const Grid& grid, const RecordFields& fields);
  /// @param branches of this grid; null: there are no ghosts.
  NodeEnergies(const Grid& grid, const BranchNodes* branches, const RecordFields& fields)
      : NodeEnergies(grid, fields) {
    if (branches) add_ghosts(grid, *branches);
  }
  void add_ghosts(const Grid& grid, const BranchNodes& branches);

  const NodeEnergy& operator[](Node node) const noexcept { return nodes_[node]; }
  /// The largest force of a node, in newtons.
  double largest_force() const;

 private:
  void add_mixed(const Grid& grid, RecordIndex r);
  NodeEnergy of_ghost(const Grid& grid, const BranchNodes& branches, Node ghost) const;

  std::vector<NodeEnergy> nodes_;
};

}  // namespace hapgrid
