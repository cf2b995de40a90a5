// The force of a play. The rule of branches takes it from the energies of the records, or where
// these do not say it, from their forces. The other rules take that of the interpolated state.
#pragma once

#include <future>
#include <limits>
#include <optional>

#include "libcore/model/fields.hpp"
#include "tools/common/node_forces.hpp"
#include "tools/common/traversals.hpp"

namespace hapgrid {

/// For one thread.
class PlayForce {
 public:
  /// Begins to ask, in other threads, what the rule needs to know of each record. @param grid
  /// outlives the answer.
  static std::future<NodeForces> ask_records(TraversalRule rule, const Grid& grid,
                                             const MakeModel& create);

  /// Says on standard error where the energies do not say the force.
  /// @param branches of the traversal; may be null. @param fields, grid outlive this.
  /// @param records from ask_records() @throw what `create` throws.
  PlayForce(const Grid& grid, const BranchNodes* branches, const Fields& fields,
            std::future<NodeForces> records);

  /// What the force comes from: "energy", "records" or "state".
  const char* source() const { return has_energy_ ? "energy" : nodes_ ? "records" : "state"; }
  /// The largest force of the grid's records, in newtons; infinite where it is not known.
  double largest() const { return largest_; }

  /// What the device makes of forces and lengths. To be called before the first tick.
  /// @param scale model units per metre; 0: not known
  void set_device(double gain, double scale) {
    gain_ = gain;
    scale_ = scale;
  }

  /// The force at the traversal's position, in each tick. Real-time safe, as far as the model.
  Vec3 operator()(const Traversal& traversal) noexcept {
    return last_ =
               nodes_ ? (*nodes_)(traversal) : fields_.force(traversal.position(), traversal.row());
  }
  /// The energy in joules that the hand can get from the model there. Real-time safe, as far as the
  /// model.
  double model_energy(const Traversal& traversal) const noexcept;
  /// NodeForce::account() in joules; nothing for other forces. Real-time safe.
  std::optional<double> account(const Traversal& traversal) const noexcept;

 private:
  const Fields& fields_;
  bool has_energy_ = false;  // of the nodes
  double largest_ = std::numeric_limits<double>::infinity();
  double gain_ = 1, scale_ = 0;
  Vec3 last_{0, 0, 0};
  std::optional<NodeForce> nodes_;
};

}  // namespace hapgrid
