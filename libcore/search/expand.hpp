// The expand filter: C in 26 directions for each frontier record (procedure expand_state).
#pragma once

#include "libcore/search/converter.hpp"
#include "libcore/search/frontier.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// Evaluates every conversion that `frontier` asks for and writes the requests to `out`.
/// Memory: the frontier records between two slices of the grid, and one batch.
/// @throw ModelError, FormatError, std::system_error
void expand(FrontierReader& frontier, Converter& converter, const GridSpec& spec,
            SectionWriter& out);

}  // namespace hapgrid
