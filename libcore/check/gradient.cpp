#include "libcore/check/gradient.hpp"

#include "libcore/follow/agreement.hpp"

namespace hapgrid {

Check check_gradient(const Grid& grid, const RecordFields& fields) {
  const Agreement found = agreement(grid, fields);
  Check check{"gradient",
              "forces",
              "the force is not the gradient of the energy, which play interpolates else",
              {},
              /*is_note=*/true};
  check.found.counted = found.predictions;
  if (found.predictions > 0 && !found.is_good())
    check.found.offend([] { return "play interpolates the forces of the records"; });
  check.figures = {
      {"force", found.force, "N", "of the records, root mean square"},
      {"error by energy", found.by_energy, "N", "of forces predicted from energies and forces"},
      {"error by forces", found.by_forces, "N", "of forces predicted from forces alone"}};
  if (found.by_forces > 0)
    check.figures.push_back(
        {"ratio", found.by_energy / found.by_forces, "",
         "of these errors; play takes the energy where it is below 0.4, or where the error by "
         "energy is at most 5 % of the force"});
  return check;
}

}  // namespace hapgrid
