// The tear fractions of a grid that has them (grid/tear.hpp).
#pragma once

#include <span>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/search/converter.hpp"

namespace hapgrid {

/// `tears`: searches the tear fractions of the one-way links of `records` again. They may differ by
/// one interval, for another machine rounds in another way. A link whose conversion fails is an
/// offender with the model's own words, and ends the search. Links without a tear fraction are left
/// to `fractions`, and states that are not finite, here or there, to `finite`.
Check check_tears(const Grid& grid, std::span<const RecordIndex> records, Converter& converter);

}  // namespace hapgrid
