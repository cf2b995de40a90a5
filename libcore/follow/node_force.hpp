// The force on the hand from what is known at the nodes of its cell (node_energies.hpp).
//
// The paper interpolates the state and evaluates the force there. But a state between two minima is
// no minimum: its force is wrong in first order and belongs to no energy. The energy of the minima
// themselves is smooth on a branch. So the energy is interpolated here, by a C1 tricubic Hermite
// from its values and slopes at the corners, and the force is its negated gradient. On a branch
// this force is conservative by construction, and continuous across the faces of cells, because it
// depends there on what the corners of the face have and on nothing else.
//
// Where the traversal changes corners without a snap, the two interpolations have different forces
// at the place of the change. What the force would lose there becomes an offset, which fades while
// the hand moves on by half a spacing, as the offset of the state does (branch_traversal.hpp). We
// fade an offset of the force and not of the energy: a fading energy would itself be a force, and
// an unbounded one on a short way. The hand therefore gains or loses the difference of the energies
// once.
//
// Where a model that walks beside the grid says its force (beside.hpp), the interpolation only says
// how the force changes until the next answer. The difference to the model's force is held as an
// offset.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libcore/follow/branch_nodes.hpp"
#include "libcore/follow/record_fields.hpp"
#include "libcore/follow/traversal.hpp"

namespace hapgrid {

// The energy at the nodes of a grid and its derivatives, from which play interpolates the force
// (node_force.hpp).

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
using NodeEnergies = std::vector<NodeEnergy>;

/// By node: the records, and then the ghosts.
/// @param fields force and energy by record @param branches of this grid; null: there are no ghosts
NodeEnergies node_energies(const Grid& grid, const RecordFields& fields,
                           const BranchNodes* branches = nullptr);
/// Appends the ghosts of `branches` to the energies of the records.
void add_ghosts(NodeEnergies& nodes, const Grid& grid, const BranchNodes& branches);
/// The largest force of a node, in newtons.
double largest_force(const NodeEnergies& nodes);

/// The nodes of the corners i + 2j + 4k of a cell.
using NodeCorners = std::array<const NodeEnergy*, 8>;

/// The energy at `part`, in [0, 1] on each axis, in newtons times the spacing.
/// Source: products of the cubic Hermite functions; the derivative xyz at the corners is 0.
double hermite_energy(const NodeCorners& corners, const Vec3& part) noexcept;
/// Its gradient, negated, in newtons.
Vec3 hermite_force(const NodeCorners& corners, const Vec3& part) noexcept;
/// The forces of the nodes themselves, interpolated linearly along each axis; newtons.
Vec3 mean_force(const NodeCorners& corners, const Vec3& part) noexcept;

/// Follows a traversal, for one thread.
class NodeForce {
 public:
  using Interpolate = Vec3 (*)(const NodeCorners&, const Vec3&) noexcept;

  /// @param interpolate hermite_force or mean_force.
  NodeForce(std::shared_ptr<const NodeEnergies> energies, const Box& box, Interpolate interpolate)
      : energies_(std::move(energies)),
        interpolate_(interpolate),
        spacing_(box.spacing),
        offset_(3, box.spacing) {}

  /// The force at the traversal's position. Called once after each step that is usable(); real-time
  /// safe. The traversal must have nodes.
  Vec3 operator()(const Traversal& traversal) noexcept;
  /// The energy there above the lowest one of the grid, in newtons times the unit of length; for
  /// nodes whose energies are known. Real-time safe.
  double energy(const Traversal& traversal) const noexcept {
    return hermite_energy(corners_of(traversal.nodes()), traversal.part()) * spacing_;
  }
  /// The energy there without what offsets of the force have done on the way; in newtons times the
  /// unit of length. Where nothing jumps, it loses in a step what the force does on the step's way.
  double account(const Traversal& traversal) const noexcept { return energy(traversal) - done_; }

 private:
  void follow(const Traversal& traversal, const NodeCorners& corners, bool jumps) noexcept;
  NodeCorners corners_of(const std::array<RecordIndex, 8>& nodes) const noexcept;
  void keep_force(const Traversal& traversal, const NodeCorners& corners) noexcept;

  std::shared_ptr<const NodeEnergies> energies_;
  Interpolate interpolate_;
  double spacing_;
  FadingOffset offset_;
  Vec3 added_{0, 0, 0};  // by offsets, to the last force
  Vec3 at_{0, 0, 0};     // the last position
  double done_ = 0;      // by offsets
};

}  // namespace hapgrid
