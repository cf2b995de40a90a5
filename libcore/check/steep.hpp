// How steep play gets on a branch, against what a device renders stably.
//
// Inside a cell the derivative of what is interpolated is a mean of the derivatives at its corners,
// each of which has the differences along the three edges there, over h. So none is larger than the
// largest difference along a two-way link; and in any direction the force changes by at most K a
// length, K² the sum over the axes of the squared larger difference of the links to either side of
// a record. Of a force that the model evaluates in the loop this is the mean over each link, not
// what it does between; and behind the end of a branch it is extrapolated, which is not looked at.
//
// A wall of stiffness K is rendered without active oscillation by a device of damping b at a rate
// of f ticks a second when K < 2 b f.
#pragma once

#include <optional>
#include <span>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `steep`, a note. Counts records; with a scale, offenders are those around which the force is too
/// stiff. Figures: the largest slopes of `state` and `force`, and the `stiffness`, or the `largest
/// stable scale`.
/// @param forces by record, in newtons; empty: of states alone
/// @param damping b, N s/m @param rate_hz f
/// @param scale model's units of length for a metre of the hand
Check check_steep(const Grid& grid, std::span<const Vec3> forces, double damping, double rate_hz,
                  std::optional<double> scale = std::nullopt);

}  // namespace hapgrid
