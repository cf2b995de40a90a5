// The live picture in a text terminal.
#pragma once

#include <string>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

struct TerminalOptions {
  RenderOptions render;  ///< all but the size, which is the terminal's
  double azimuth_degrees = Camera{}.azimuth_degrees;
  double elevation_degrees = Camera{}.elevation_degrees;
  std::string mode = "auto";  ///< or "symbols", "sixel", "kitty"
};

/// Shows the frames of `frames` ("-": standard input) on standard output until they end, and leaves
/// the last picture there. Nothing is read from the terminal, and its input is not touched: the
/// keyboard can be another program's. A signal that ends the process does so after the terminal is
/// as it was.
/// @throw Error when standard output is no terminal; std::system_error; what Feed throws.
void run_terminal(const std::string& frames, const TerminalOptions& options);

}  // namespace hapgrid
