// The texts over a picture: the axes x, y and z and a scale bar in the lower left corner, and
// beside the model the names of torsions that have turned. view's page draws the same; the numbers
// here are for both, in pixels at scale 1.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

inline constexpr double kMargin = 10;         ///< from the picture's edges
inline constexpr double kAxis = 45;           ///< an axis's length at most,
inline constexpr double kAxisPart = 0.12;     ///< and as a part of the picture's shorter side
inline constexpr double kAxesAside = 26;      ///< from the left edge to the axes, but for a length
inline constexpr double kAxesAbove = 40;      ///< from the lower edge, alike
inline constexpr double kAxisGap = 9;         ///< from an axis's end to the middle of its name
inline constexpr double kShortestAxis = 0.3;  ///< part of an axis's length that is seen at least
inline constexpr double kLegendLine = 1.2;    ///< the width of all its lines
inline constexpr double kDot = 2.5;           ///< the radius of the dot at a torsion's bond
inline constexpr double kBarEnd = 3;        ///< of the strokes at the scale bar's ends, up and down
inline constexpr double kBarGap = 5;        ///< from the bar to its text
inline constexpr double kBarPart = 0.25;    ///< of the picture's width, for the scale bar at most
inline constexpr double kNameRow = 16;      ///< from one name of a torsion to the next
inline constexpr double kNamesPart = 0.35;  ///< of the picture's width, that names can take
inline constexpr double kSmallest = 150;    ///< of a picture's sides, for any of this

/// A length with its unit: "2 Å".
std::string length_text(const Scene& scene, double length);

/// The width of the longest name that a torsion can have, with margins; 0 without torsions.
double names_width(const Scene& scene);

/// Draws the axes and the bar, which is 1, 2 or 5 times a power of ten long. The axes have one
/// length in the model's space, of which the picture shows what lies in its plane.
void add_legend(Drawing& drawing, const Scene& scene, const Camera& camera,
                const RenderOptions& options);

/// Draws the texts in a column to the right of the rightmost sphere, so that they cover none, each
/// at the height of its place in the drawing, or below the one before or above the rest. A dot
/// marks the place; a line goes towards it, and ends before it crosses a sphere.
void add_names(Drawing& drawing, std::vector<std::pair<Vec3, std::string>> names,
               const RenderOptions& options);

}  // namespace hapgrid
