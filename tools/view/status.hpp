// The numbers of a frame as a line of text.
#pragma once

#include <string>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// "t 3.24 s   force 0.513 N   energy 9.1 kJ/mol of the model alone, 12.3 with the hand   psi
/// +67°": the energy, and first that of the model itself, if the model has one; the torsion that
/// has turned farthest, if one has.
std::string status_text(const Scene& scene, const Frame& frame);

}  // namespace hapgrid
