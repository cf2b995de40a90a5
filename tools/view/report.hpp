// What view says of a file of frames.
#pragma once

#include <string>

#include "libcore/scene/scene.hpp"
#include "libcore/scene/summary.hpp"

namespace hapgrid {

/// Lines for people: times in s, forces in newtons, lengths and energies in the scene's units.
std::string report_text(const Scene& scene, const SceneSummary& s);
/// The same and the box, as JSON. What no frame has is null.
std::string report_json(const Scene& scene, const SceneSummary& s);

}  // namespace hapgrid
