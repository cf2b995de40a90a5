// The live picture in a window.
#pragma once

#include <string>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

struct WindowOptions {
  RenderOptions render;  ///< width and height are the window's
  double azimuth_degrees = Camera{}.azimuth_degrees;
  double elevation_degrees = Camera{}.elevation_degrees;
  bool close = false;      ///< at the end of the stream
  std::string screenshot;  ///< PNG of the last picture; empty: none
  std::string hand;        ///< the pipe in which play reads the mouse as a hand; empty: none
};

/// Shows the frames of `frames` ("-": standard input) until the window is closed.
/// @throw Error when there is no display or no OpenGL 3.3; what Feed throws: for damage behind the
/// scene only after the window is closed; what Hand throws.
void run_window(const std::string& frames, const WindowOptions& options);

}  // namespace hapgrid
