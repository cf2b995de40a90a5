#include "tools/common/force_rules.hpp"

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/haptic/agreement.hpp"

namespace hapgrid {

namespace {

struct NamedForce {
  ForceRule rule;
  const char* name;
};
constexpr NamedForce kForces[] = {
    {ForceRule::kEnergy, "energy"}, {ForceRule::kRecords, "records"}, {ForceRule::kState, "state"}};

/// Why the force cannot come from the energy; empty where it can.
std::string objection(const Grid& grid, const RecordFields& fields) {
  if (fields.energy.empty()) return "no energy is known";
  const Agreement found = agreement(grid, fields);
  if (found.is_good()) return "";
  if (found.predictions == 0) return "the grid is too small to compare force and energy";
  return format(
      "the force is not the gradient of the energy (off by {} N with the energy, {} N without)",
      rounded(found.by_energy), rounded(found.by_forces));
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
  NodeForces found{wanted, {}, std::make_shared<NodeEnergies>(grid, fields), {}};
  if (wanted == ForceRule::kEnergy) found.why_not = objection(grid, fields);
  if (!found.why_not.empty()) found.rule = ForceRule::kRecords;
  found.interpolate = found.rule == ForceRule::kEnergy ? hermite_force : mean_force;
  return found;
}

}  // namespace hapgrid
