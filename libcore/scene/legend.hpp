// The legend in the lower left corner of a picture: the axes x, y and z, and a scale
// bar.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

// The axes, in pixels at scale 1.
inline constexpr double kAxis = 45;           ///< an axis's length at most,
inline constexpr double kAxisPart = 0.12;     ///< and as a part of the picture's shorter side
inline constexpr double kAxisGap = 9;         ///< between an axis's end and the middle of its name
inline constexpr double kShortestAxis = 0.3;  ///< part of an axis's length that is seen at least

struct Legend {
  /// Lines from one point to another, in pixels.
  std::vector<std::array<std::array<double, 2>, 2>> lines;
  std::vector<Label> labels;  ///< how long the bar is, "2 Å", and the names of the axes
};

/// A length with its unit: "2 Å".
std::string length_text(const Scene& scene, double length);

/// The legend of a picture; empty if the picture is too small for one. The bar is 1, 2 or 5
/// times a power of ten long, and at most a quarter of the width. The axes have one length in the
/// model's space; the picture shortens those that do not lie in its plane.
Legend make_legend(const Scene& scene, const Camera& camera, const RenderOptions& options);

/// Draws the legend over everything, with its letters if the options want them.
void add_legend(Drawing& drawing, const Scene& scene, const Camera& camera,
                const RenderOptions& options);

/// Draws a text on a white plate over everything, with its middle at x, y of the drawing.
void add_plate(Drawing& drawing, const std::string& text, double x, double y,
               const RenderOptions& options);

}  // namespace hapgrid
