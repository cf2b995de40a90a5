// Algorithm 1 in one process: rounds of expand and merge in memory until the frontier is
// empty.
#pragma once

#include <functional>

#include "libcore/search/converter.hpp"
#include "libcore/search/partial.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// Completes a grid. `open` is called once, with the header of the finished grid, and gives the
/// writer for it. The bytes are those that rounds of expand and merge end with.
/// @param partial keeps the last whole generation in a file, and the message of an error names that
/// generation; `grid` must be what partial->start() answered. With null, nothing is kept.
/// @throw Stopped, Error (level limit), ModelError, FormatError, std::system_error
void complete(const Section& grid, Converter& converter, Progress& progress,
              const std::function<SectionWriter(const SectionHeader&)>& open,
              PartialGrid* partial = nullptr);

}  // namespace hapgrid
