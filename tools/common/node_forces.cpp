#include "tools/common/node_forces.hpp"

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/follow/record_fields.hpp"

namespace hapgrid {

namespace {

// Errors that are smaller, as a part of the force, say nothing: energies are kept as floats.
constexpr double kRounding = 1e-6;

constexpr const char* kEither =
    ", since the grid is too coarse or the force is not their gradient; verify says which";

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
    into.why_not = "the energies do not tell of the forces " + errors + kEither;
  else if (!found.is_sure())
    into.remark = "the energies tell little of the forces " + errors + kEither;
  else if (found.by_energy > found.by_forces && found.by_energy > kRounding * found.force)
    into.remark = "the energy agrees less well with the forces than the forces' mean " + errors;
}

}  // namespace

NodeForces node_forces(const Grid& grid, const RecordFields& fields) {
  NodeForces found{std::make_shared<NodeEnergies>(node_energies(grid, fields)), {}, {}};
  judge(grid, fields, found);
  return found;
}

}  // namespace hapgrid
