#include "tools/play/played_force.hpp"

#include <algorithm>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/check/forces.hpp"
#include "tools/common/tool.hpp"

namespace hapgrid {

PlayForce::PlayForce(std::optional<ForceRule> wanted, TraversalRule traversal, const Grid& grid,
                     const Sheets* sheets, const Fields& fields, const MakeModel& create)
    : fields_(fields), rule_(wanted.value_or(default_force(traversal))) {
  if (rule_ == ForceRule::kState) return;
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const NodeForces found = node_forces(rule_, grid, sheets, shared_fields(grid, create, threads));
  if (!found.why_not.empty()) {
    if (wanted) throw Error("--force energy: " + found.why_not);
    say("play", found.why_not + ": the forces of the records are interpolated");
  }
  rule_ = found.rule;
  nodes_.emplace(found.nodes, grid.box(), found.interpolate);
}

}  // namespace hapgrid
