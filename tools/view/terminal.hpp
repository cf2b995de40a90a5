// The live picture in a text terminal.
#pragma once

#include <string>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

/// Shows the frames of `frames` ("-": standard input) on standard output until they end, and leaves
/// the last picture there. `mode` is "auto", "symbols" or "sixel"; the size of `how` is not used:
/// it is the terminal's. The terminal's input is neither read nor changed, so another program can
/// use the keyboard. A signal ends the process after the terminal is as before.
/// @throw Error when standard output is no terminal; std::system_error; what Feed throws.
void run_terminal(const std::string& frames, const RenderOptions& how, const std::string& mode);

}  // namespace hapgrid
