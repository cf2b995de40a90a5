#include "tools/play/played_force.hpp"

#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/follow/record_fields.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

// A contact of a model whose energy is not known counts as one that is as deep as this, in metres
// of the hand: so deep that a tremor does not reach its end.
constexpr double kUnknownDepth = 1e-3;

}  // namespace

std::future<NodeForces> PlayForce::ask_records(TraversalRule rule, const Grid& grid,
                                               const MakeModel& create) {
  if (rule != TraversalRule::kBranch) return {};
  // One processor does one thing after the other, without a thread.
  const auto launch = all_threads() > 1 ? std::launch::async : std::launch::deferred;
  return std::async(launch, [&grid, create] {
    return node_forces(grid, record_fields(grid, create, all_threads()));
  });
}

PlayForce::PlayForce(const Grid& grid, const BranchNodes* branches, const Fields& fields,
                     std::future<NodeForces> records)
    : fields_(fields) {
  if (!records.valid()) return;
  const NodeForces found = records.get();
  if (branches) add_ghosts(*found.nodes, grid, *branches);
  if (!found.has_energy())
    say("play", format("{}: the forces of the records are interpolated", found.why_not));
  if (!found.remark.empty()) say("play", found.remark);
  has_energy_ = found.has_energy();
  largest_ = largest_force(*found.nodes);
  nodes_.emplace(found.nodes, grid.box(), found.interpolate());
}

double PlayForce::model_energy(const Traversal& traversal) const noexcept {
  if (!(scale_ > 0)) return 0;
  if (has_energy_) return gain_ * (nodes_->energy(traversal) / scale_);
  if (!fields_.has_energy()) return gain_ * (kUnknownDepth * length_of(last_));
  const double energy =
      fields_.energy(traversal.position(), traversal.row()) * fields_.force_scale();
  return gain_ * (energy / scale_);
}

std::optional<double> PlayForce::account(const Traversal& traversal) const noexcept {
  if (!has_energy_ || !(scale_ > 0)) return std::nullopt;
  return gain_ / scale_ * nodes_->account(traversal);
}

}  // namespace hapgrid
