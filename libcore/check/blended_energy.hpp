// How far a blend of several branches is from anything that the model knows: the energy of the
// interpolated state, against the energies of the states that are interpolated.
#pragma once

#include <cstdint>

#include "libcore/check/configurations.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/haptic/sheets.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

struct BlendedEnergy {
  /// How far the energy in the middle of a cell is outside the range of its corners' energies, at
  /// most; in the model's unit.
  double leaves = 0;
  PointIndex base = 0;      ///< of that cell
  std::uint64_t cells = 0;  ///< that were looked at, once for each way to blend

  /// Of a check of such cells. Empty where nothing was looked at.
  std::vector<Figure> figures(const GridSpec& spec, const Box& box) const;
};

/// Whether there is an energy to ask for: a stored one would be interpolated itself.
bool can_ask_energy(const GridSpec& spec, const Fields& fields);

/// Of the cells that are mixed by the rule of branches (Sheets::is_mixed()).
BlendedEnergy energy_of_branches(const Grid& grid, const Sheets& sheets, const Fields& fields);

/// Of the configurations that are mixed by the paper's rule.
BlendedEnergy energy_of_configurations(const Grid& grid, const Configurations& found,
                                       const Fields& fields);

/// Of the eight records that a corner's record leads to, where they are not linked with each other.
BlendedEnergy energy_of_blends(const Grid& grid, const Fields& fields);

}  // namespace hapgrid
