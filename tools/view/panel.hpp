// The strip below a window's picture: the newest numbers, and force and energy as curves.
#pragma once

#include <string>
#include <vector>

#include "libcore/scene/image.hpp"
#include "libcore/scene/scene.hpp"
#include "tools/view/traces.hpp"

namespace hapgrid {

/// At scale 1, in pixels.
inline constexpr int kPanelHeight = 120;

/// `width` x (scale * kPanelHeight) pixels. Curves go from Traces::kSeconds ago to the newest
/// sample on the right; where the state snapped there is a vertical line.
Image draw_panel(int width, int scale, const Scene& scene, const Traces& traces,
                 const std::string& status);

/// The same strip with lines of text instead of curves.
Image draw_text(int width, int scale, const std::vector<std::string>& lines);

}  // namespace hapgrid
