// The work along links as play does it, where the force comes from the nodes of the cell
// (haptic/node_force.hpp): the interpolated energy's gradient, or the interpolated forces.
//
// Along the edge of a cell such a force depends on the edge's two nodes alone, so its work is known
// exactly, and nothing has to be allowed but rounding. Therefore walks take the links along the
// axes. On a one-way link the hand follows the branch to where play snaps, which is where the tear
// function is 0, and then the branch on which it goes on.
//
// So a closed walk on one branch has no work at all where play interpolates the energy; it can gain
// where a snap leads up, and where a limit cuts the force. What the energy at a snap is off by,
// because the branches beyond their ends are extrapolated, is allowed.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "libcore/check/work.hpp"
#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/node_force.hpp"

namespace hapgrid {

/// What of the force reaches the hand: gain times it, shortened to max_force.
struct ForceLimit {
  double gain = 1;
  double max_force = std::numeric_limits<double>::infinity();  ///< newtons

  bool cuts() const { return max_force < std::numeric_limits<double>::infinity(); }
  Vec3 operator()(const Vec3& force) const noexcept;
};

class PlayedWork final : public Work {
 public:
  /// @param interpolate as NodeForce takes it. @param grid, map, nodes outlive this.
  /// @param threads at least 1; the result does not depend on it.
  PlayedWork(const Grid& grid, const BranchMap& map, const NodeEnergies& nodes,
             NodeForce::Interpolate interpolate, const ForceLimit& limit, int threads);

  bool takes(int q) const override;
  double gain(const Link& link) const override { return gains_[slot(link)]; }
  double allowance(const Link& link) const override;
  std::optional<double> energy(RecordIndex r) const override;

 private:
  static std::size_t slot(const Link& link);
  double snap(const Link& link) const;
  double integrate(const Link& link) const;
  double along(Node low, Node high, int axis, double begin, double end) const;

  const BranchMap& map_;
  const NodeEnergies& nodes_;
  NodeForce::Interpolate interpolate_;
  ForceLimit limit_;
  std::vector<double> gains_;  // by record, and direction along an axis: they are asked for often
};

}  // namespace hapgrid
