// What view's page is made of. The page shows the scene in 3-D, which one can turn, the curves of
// force and energy, marks where the state snapped, and a slider for the time. In the file of --html
// the frames are in the page; the live page of --web gets the same texts as messages; the page of a
// grid (grid_page.hpp) makes its frames itself. Nothing is loaded from elsewhere: the scripts and
// the numbers are in the page.
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
                                  const RenderOptions& options);

/// A frame: the HIP is held in the box; arrow has the arrow_sizes(); centres are x y z by sphere,
/// and bonds pairs of spheres; status is a line of numbers for people; turned has for each torsion
/// that has turned the two spheres of its bond and its name. What is not finite is null.
nlohmann::ordered_json page_frame(const Scene& scene, const Frame& frame);

/// The page with the text of its data, and those of frames with commas between them.
/// @param packed JSON: the grid that the page plays by itself, and its player
std::string page_text(const std::string& data, const std::string& shown,
                      const std::string& packed = "null");

/// JSON that can stand in a script: a stream's strings cannot end it.
std::string script_of(const nlohmann::ordered_json& json);

}  // namespace hapgrid
