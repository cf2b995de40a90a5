// Command lines that play refuses before it opens anything.
#pragma once

#include "tools/play/options.hpp"

namespace hapgrid {

/// @throw UsageError, Error for a command line that cannot be played: what is missing, excludes
/// each other, or would replace an input.
void require_possible(const PlayOptions& options);

}  // namespace hapgrid
