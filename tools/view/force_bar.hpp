// The size of the force as a bar at the right edge of the picture.
#pragma once

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

/// Draws it in front of everything, unless the picture is too small for it.
/// @param newtons of the force. @param full what fills the bar, in newtons; > 0.
void add_force_bar(Drawing& drawing, double newtons, double full, const RenderOptions& options);

}  // namespace hapgrid
