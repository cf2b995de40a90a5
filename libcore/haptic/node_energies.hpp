// The energy at the nodes of a grid and its derivatives, from which play interpolates the force
// (node_force.hpp).
#pragma once

#include <array>
#include <vector>

#include "libcore/haptic/sheets.hpp"

namespace hapgrid {

/// Force and energy at the records of a grid, as the grid stores them or its model gives them.
struct RecordFields {
  std::vector<Vec3> force;     ///< newtons, by record
  std::vector<double> energy;  ///< newtons times the model's unit of length; empty: not known
};

/// What is known at a node, all in newtons: lengths are measured in spacings.
struct NodeEnergy {
  float energy = 0;              ///< above an energy that all nodes have in common
  std::array<float, 3> slope{};  ///< of the energy along x, y, z: the force, negated
  std::array<float, 3> mixed{};  ///< mixed second derivatives: of yz, xz, xy
};

/// By node: 28 bytes for a record.
///
/// The energy of a state at rest is smooth on a branch, and its gradient there is the negated
/// force, so energy and slope are known exactly. The mixed derivatives are differences of the
/// slopes along two-way links. A ghost has what its branch would have at its point: slopes are
/// extrapolated linearly, and the energy is that of the records beside it and the mean slope on the
/// way.
class NodeEnergies {
 public:
  /// @param sheets of this grid; null: there are no ghosts.
  NodeEnergies(const Grid& grid, const Sheets* sheets, const RecordFields& fields);

  const NodeEnergy& operator[](Node node) const noexcept { return nodes_[node]; }

 private:
  void add_mixed(const Grid& grid, RecordIndex r);
  void add_ghosts(const Grid& grid, const Sheets& sheets);

  std::vector<NodeEnergy> nodes_;
};

}  // namespace hapgrid
