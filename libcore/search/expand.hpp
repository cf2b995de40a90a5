// The expand filter: C in 26 directions for each frontier record (procedure expand_state).
#pragma once

#include <functional>

#include "libcore/search/converter.hpp"
#include "libcore/search/frontier.hpp"

namespace hapgrid {

/// Takes the requests as they are found, ascending by target.
using RequestSink =
    std::function<void(PointIndex target, int q, Level source_level, const double* row)>;

/// Evaluates every conversion that `frontier` asks for and gives the requests to `out`.
/// Memory: the frontier records between two slices of the grid, and one batch.
/// @throw ModelError, FormatError, std::system_error; what `out` throws
void expand(FrontierReader& frontier, Converter& converter, const GridSpec& spec,
            const RequestSink& out);

}  // namespace hapgrid
