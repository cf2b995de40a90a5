#include "tools/common/force_rules.hpp"

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/follow/agreement.hpp"

namespace hapgrid {

namespace {

struct NamedForce {
  ForceRule rule;
  const char* name;
};
constexpr NamedForce kForces[] = {
    {ForceRule::kEnergy, "energy"}, {ForceRule::kRecords, "records"}, {ForceRule::kState, "state"}};

// Errors that are smaller, as a part of the force, say nothing: energies are kept as floats.
constexpr double kRounding = 1e-6;

/// Says why the force cannot come from the energy, or what is odd about it.
void judge(const Grid& grid, const RecordFields& fields, NodeForces& into) {
  if (fields.energy.empty()) {
    into.why_not = "no energy is known";
    return;
  }
  const Agreement found = agreement(grid, fields);
  const std::string errors = format("(off by {} N with the energy, {} N without)",
                                    rounded(found.by_energy), rounded(found.by_forces));
  if (found.predictions == 0)
    into.why_not = "the grid is too small to compare force and energy";
  else if (!found.is_good())
    into.why_not = "the force is not the gradient of the energy " + errors;
  else if (found.by_energy > found.by_forces && found.by_energy > kRounding * found.force)
    into.remark = "the energy agrees less well with the forces than the forces' mean " + errors;
}

}  // namespace

const char* name_of(ForceRule rule) {
  for (const NamedForce& f : kForces)
    if (f.rule == rule) return f.name;
  return "";
}

std::optional<ForceRule> force_named(const std::string& name) {
  for (const NamedForce& f : kForces)
    if (name == f.name) return f.rule;
  return std::nullopt;
}

ForceRule default_force(TraversalRule traversal) {
  return traversal == TraversalRule::kBranch ? ForceRule::kEnergy : ForceRule::kState;
}

NodeForces node_forces(ForceRule wanted, const Grid& grid, const RecordFields& fields) {
  NodeForces found{wanted, {}, {}, std::make_shared<NodeEnergies>(grid, fields), {}};
  if (wanted == ForceRule::kEnergy) judge(grid, fields, found);
  if (!found.why_not.empty()) found.rule = ForceRule::kRecords;
  found.interpolate = found.rule == ForceRule::kEnergy ? hermite_force : mean_force;
  return found;
}

}  // namespace hapgrid
