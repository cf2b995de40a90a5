// The angle of four spheres.
#pragma once

#include <string>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Degrees in [-180, 180], positive clockwise when one looks from the second sphere to the third
/// (IUPAC); NaN where three of the spheres stand on a line or a place is not finite.
double torsion_degrees(const Torsion& torsion, const Frame& frame);

/// From so many degrees on, a torsion that has turned is named.
inline constexpr double kTurned = 10;

/// "psi +67°": a torsion that has turned, and how far.
std::string turned_text(const Torsion& torsion, double degrees);

}  // namespace hapgrid
