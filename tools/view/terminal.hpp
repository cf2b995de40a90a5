// The live picture in a text terminal.
#pragma once

#include <string>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

struct TerminalOptions {
  RenderOptions render;  ///< the size is not used: it is the terminal's
  double azimuth_degrees = Camera{}.azimuth_degrees;
  double elevation_degrees = Camera{}.elevation_degrees;
  std::string mode = "auto";  ///< or "symbols", "sixel"
};

/// Shows the frames of `frames` ("-": standard input) on standard output until they end, and leaves
/// the last picture there. The terminal's input is neither read nor changed, so another program can
/// use the keyboard. A signal ends the process after the terminal is as before.
/// @throw Error when standard output is no terminal; std::system_error; what Feed throws.
void run_terminal(const std::string& frames, const TerminalOptions& options);

}  // namespace hapgrid
