// What view's page is made of. The page shows the scene in 3-D, which one can turn, the curves of
// force and energy, marks where the state snapped, and a slider for the time. In the file of --html
// the frames are in the page; the live page of --web gets the same bytes as messages. Nothing is
// loaded from elsewhere: the scripts and the numbers are in the page.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "libcore/scene/drawing.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// All that the scripts have to know of a scene: its names, colours, sizes and limits, the camera,
/// the light, and the lengths that a legend can have. @param frame the first, which the camera
/// shows.
nlohmann::ordered_json page_scene(const Scene& scene, const Frame& frame,
                                  const RenderOptions& options, double azimuth_degrees,
                                  double elevation_degrees);

/// A frame in little endian: the time and the jumps as doubles, and the number of bonds in 32 bits;
/// then floats: the HIP held in the box, the force, the hand (NaN where there is none), the
/// energies, the arrow_sizes(), the spheres' centres; then the bonds as pairs of 16 bits; then a
/// text of lines: the numbers for people, and for each torsion that has turned the two spheres of
/// its bond and its name.
std::string page_frame(const Scene& scene, const Frame& frame, const RenderOptions& options);

/// The page with the text of its data.
std::string page_text(const std::string& data);

/// JSON that can stand in a script: a stream's strings cannot end it.
std::string script_of(const nlohmann::ordered_json& json);

/// Bytes as an ASCII text, which JSON can hold.
std::string base64(const std::string& bytes);

}  // namespace hapgrid
