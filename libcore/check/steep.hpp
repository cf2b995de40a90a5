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

#include <span>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// `steep`, a note that counts records. Figures: the largest slopes of `state` and `force`, and for
/// a device of b = 2 N s/m at f = 1000 Hz the `largest stable scale`, in model's units of length
/// for a metre of the hand, and the `shortest stable reach`, in metres along each axis, of a device
/// whose reach fills the box.
/// @param forces by record, in newtons; empty: of states alone
Check check_steep(const Grid& grid, std::span<const Vec3> forces);

}  // namespace hapgrid
