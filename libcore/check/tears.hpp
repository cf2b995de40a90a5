// The tear fractions of a grid that has them (grid/tear.hpp).
#pragma once

#include <span>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/search/converter.hpp"

namespace hapgrid {

/// `tears`: searches the tear fractions of the one-way links of `records` again. A difference of
/// one interval is allowed, because machines round differently. A link whose conversion fails is an
/// offender, with the message of the model, and ends the search. Links without a tear fraction are
/// offenders of `fractions`, and states that are not finite are offenders of `finite`; both are
/// skipped here.
Check check_tears(const Grid& grid, std::span<const RecordIndex> records, Converter& converter);

}  // namespace hapgrid
