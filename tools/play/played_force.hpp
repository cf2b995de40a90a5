// The force of a play, by the rule that --force names.
#pragma once

#include <future>
#include <limits>
#include <optional>

#include "libcore/model/fields.hpp"
#include "tools/common/force_rules.hpp"

namespace hapgrid {

/// For one thread.
class PlayForce {
 public:
  /// What a force that is not kState needs to know of each record; begins to ask, in other threads.
  /// Arguments as below; grid outlives the answer.
  static std::future<NodeForces> ask_records(std::optional<ForceRule> wanted,
                                             TraversalRule traversal, const Grid& grid,
                                             const MakeModel& create);

  /// @param wanted nothing: kEnergy for the rule of branches, or kRecords where no energy has the
  /// forces as its gradient; kState for the other rules of traversal. Says on standard error where
  /// it falls back to kRecords.
  /// @param branches of the traversal; may be null. @param fields, grid outlive this.
  /// @param records from ask_records()
  /// @throw Error when kEnergy is wanted and cannot be had; what `create` throws.
  PlayForce(std::optional<ForceRule> wanted, TraversalRule traversal, const Grid& grid,
            const BranchNodes* branches, const Fields& fields, std::future<NodeForces> records);

  ForceRule rule() const { return rule_; }
  /// The largest force of the grid's records, in newtons; infinite where it is not known.
  double largest() const { return largest_; }

  /// The force at the traversal's position, in each tick. Real-time safe, as far as the model.
  Vec3 operator()(const Traversal& traversal) noexcept {
    return nodes_ ? (*nodes_)(traversal) : fields_.force(traversal.position(), traversal.row());
  }
  /// NodeForce::account(); nothing for other forces. Real-time safe.
  std::optional<double> account(const Traversal& traversal) const noexcept {
    if (rule_ != ForceRule::kEnergy) return std::nullopt;
    return nodes_->account(traversal);
  }
  /// The energy that the hand can get from the model there, in newtons times the model's unit of
  /// length; nothing where it is not known. Real-time safe, as far as the model.
  std::optional<double> model_energy(const Traversal& traversal) const noexcept {
    if (rule_ == ForceRule::kEnergy) return nodes_->energy(traversal);
    if (!fields_.has_energy()) return std::nullopt;
    return fields_.energy(traversal.position(), traversal.row()) * fields_.force_scale();
  }

 private:
  const Fields& fields_;
  ForceRule rule_;
  double largest_ = std::numeric_limits<double>::infinity();
  std::optional<NodeForce> nodes_;
};

}  // namespace hapgrid
