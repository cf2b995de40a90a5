// The angle of four spheres.
#pragma once

#include <cmath>
#include <string>

#include "libcore/scene/scene.hpp"

namespace hapgrid {

/// Degrees in [-180, 180], positive clockwise when one looks from the second sphere to the third
/// (IUPAC); NaN where three of the spheres stand on a line or a place is not finite.
double torsion_degrees(const Torsion& torsion, const Frame& frame);

/// By how many degrees an angle has turned, in (-180, 180].
inline double turned_degrees(double first, double now) {
  return -std::remainder(first - now, 360);  // 180, never -180
}

/// Pictures name a torsion that has turned by so many degrees or more.
inline constexpr double kTurned = 10;

/// The name of a torsion, and how far it has turned: "psi +67°".
std::string turned_text(const Torsion& torsion, double degrees);

}  // namespace hapgrid
