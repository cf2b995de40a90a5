#include "tools/play/forces.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/haptic/agreement.hpp"

namespace hapgrid {

namespace {

struct Rule {
  ForceRule rule;
  const char* name;
};
constexpr Rule kRules[] = {
    {ForceRule::kEnergy, "energy"}, {ForceRule::kRecords, "records"}, {ForceRule::kState, "state"}};

/// Why the force cannot come from the energy; empty where it can.
std::string objection(const Grid& grid, const RecordFields& fields) {
  if (fields.energy.empty()) return "no energy is known";
  const Agreement found = agreement(grid, fields);
  if (found.is_good()) return "";
  if (found.predictions == 0) return "the grid is too small to compare force and energy";
  return "the force is not the gradient of the energy (off by " + rounded(found.by_energy) +
         " N with the energy, " + rounded(found.by_forces) + " N without)";
}

}  // namespace

const char* name_of(ForceRule rule) {
  for (const Rule& r : kRules)
    if (r.rule == rule) return r.name;
  return "";
}

std::optional<ForceRule> force_named(const std::string& name) {
  for (const Rule& r : kRules)
    if (name == r.name) return r.rule;
  return std::nullopt;
}

PlayForce::PlayForce(std::optional<ForceRule> wanted, TraversalRule traversal, const Grid& grid,
                     const Sheets* sheets, const Fields& fields, const MakeModel& create)
    : fields_(fields),
      rule_(wanted.value_or(traversal == TraversalRule::kBranch ? ForceRule::kEnergy
                                                                : ForceRule::kState)) {
  if (rule_ == ForceRule::kState) return;
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const RecordFields at_records = record_fields(grid, create, threads);
  if (rule_ == ForceRule::kEnergy) {
    const std::string why_not = objection(grid, at_records);
    if (!why_not.empty() && wanted) throw Error("--force energy: " + why_not);
    if (!why_not.empty()) {
      std::fprintf(stderr, "play: %s: the forces of the records are interpolated\n",
                   why_not.c_str());
      rule_ = ForceRule::kRecords;
    }
  }
  nodes_.emplace(std::make_shared<const NodeEnergies>(grid, sheets, at_records), grid.box(),
                 rule_ == ForceRule::kEnergy ? hermite_force : mean_force);
}

}  // namespace hapgrid
