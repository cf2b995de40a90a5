#include "tools/play/played_force.hpp"

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/follow/record_fields.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

std::future<NodeForces> PlayForce::ask_records(std::optional<ForceRule> wanted,
                                               TraversalRule traversal, const Grid& grid,
                                               const MakeModel& create) {
  const ForceRule rule = wanted.value_or(default_force(traversal));
  if (rule == ForceRule::kState) return {};
  // One processor does one thing after the other, without a thread.
  const auto launch = all_threads() > 1 ? std::launch::async : std::launch::deferred;
  return std::async(launch, [&grid, create, rule] {
    return node_forces(rule, grid, record_fields(grid, create, all_threads()));
  });
}

PlayForce::PlayForce(std::optional<ForceRule> wanted, TraversalRule traversal, const Grid& grid,
                     const BranchNodes* branches, const Fields& fields,
                     std::future<NodeForces> records)
    : fields_(fields), rule_(wanted.value_or(default_force(traversal))) {
  if (rule_ == ForceRule::kState) return;
  const NodeForces found = records.get();
  if (branches) found.nodes->add_ghosts(grid, *branches);
  if (!found.why_not.empty()) {
    if (wanted) throw Error(format("--force energy: {}", found.why_not));
    say("play", format("{}: the forces of the records are interpolated", found.why_not));
  }
  if (!found.remark.empty()) say("play", found.remark);
  rule_ = found.rule;
  largest_ = found.nodes->largest_force();
  nodes_.emplace(found.nodes, grid.box(), found.interpolate);
}

}  // namespace hapgrid
