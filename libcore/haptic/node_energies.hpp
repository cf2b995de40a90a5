// The energy at the nodes of a grid and its derivatives, from which play interpolates the force
// (node_force.hpp).
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "libcore/base/large_array.hpp"
#include "libcore/base/ranked_bits.hpp"
#include "libcore/haptic/sheets.hpp"

namespace hapgrid {

/// Where the values of each record stand in a column: at its own number; or, where most records
/// have the same, at 0, and behind it those of the records that have their own.
class RecordSlots {
 public:
  RecordSlots() = default;
  explicit RecordSlots(RankedBits own) : own_(std::move(own)) {}

  bool is_shared() const { return !own_.empty(); }
  /// Real-time safe.
  std::size_t operator[](RecordIndex r) const noexcept {
    return own_.empty() ? r : own_.has(r) ? std::size_t{1} + own_.rank(r) : 0;
  }
  std::size_t size(RecordIndex records) const {
    return own_.empty() ? records : std::size_t{1} + own_.count();
  }
  /// Of those that have their own values.
  const RankedBits& own() const { return own_; }

 private:
  RankedBits own_;
};

/// Force and energy at the records of a grid, as the grid stores them or its model gives them.
struct RecordFields {
  std::vector<Vec3> force;     ///< newtons, by slot
  std::vector<double> energy;  ///< by slot; newtons times the unit of length; empty: not known
  RecordSlots slots = {};      ///< of each record; the slot that records share has no force
};

/// What is known at a node, all in newtons: lengths are measured in spacings.
struct NodeEnergy {
  float energy = 0;              ///< above an energy that all nodes have in common
  std::array<float, 3> slope{};  ///< of the energy along x, y, z: the force, negated
  std::array<float, 3> mixed{};  ///< mixed second derivatives: of yz, xz, xy
};

/// By node: 28 bytes for a record that is pushed. The others share one node where the fields do.
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
  /// @param sheets of this grid; null: there are no ghosts.
  NodeEnergies(const Grid& grid, const Sheets* sheets, const RecordFields& fields)
      : NodeEnergies(grid, fields) {
    if (sheets) add_ghosts(grid, *sheets);
  }
  void add_ghosts(const Grid& grid, const Sheets& sheets);

  const NodeEnergy& operator[](Node node) const noexcept {
    return node < records_ ? nodes_[slots_[node]] : ghosts_[node - records_];
  }

 private:
  void add_mixed(const Grid& grid, RecordIndex r);
  NodeEnergy of_ghost(const Grid& grid, const Sheets& sheets, Node ghost) const;

  RecordIndex records_;
  RecordSlots slots_;
  LargeArray<NodeEnergy> nodes_;  // by slot
  std::vector<NodeEnergy> ghosts_;
};

}  // namespace hapgrid
