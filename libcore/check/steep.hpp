// How steep play gets, over every configuration that it can be in, against what a device renders
// stably.
//
// The interpolated state's derivative along an axis is a mean of the differences along the four
// edges of the cell in that direction, over h: none is larger than the largest edge's. The same
// holds for a stored force, which play interpolates, and then in any direction the force changes by
// at most K a length, K² the sum over the axes of the squared largest differences over h. Of a
// force that the model evaluates in the loop this is the mean over each edge, not what it does
// between.
//
// A wall of stiffness K is rendered without active oscillation by a device of damping b at a rate
// of f ticks a second when K < 2 b f.
#pragma once

#include <cstdint>
#include <optional>

#include "libcore/check/configurations.hpp"
#include "libcore/check/forces.hpp"
#include "libcore/check/report.hpp"

namespace hapgrid {

/// What holds the device, and how large the model is on it.
struct Rendering {
  double damping = 2;             ///< b, N s/m
  double rate_hz = 1000;          ///< f
  std::optional<double> scale{};  ///< model's units of length for a metre of the hand

  /// The largest stable stiffness, N/m.
  double limit() const { return 2 * damping * rate_hz; }
};

/// `steep`, a note. Counts configurations; with a scale, offenders are those that are too stiff.
/// @param forces nullptr: of states alone
/// @param threads at least 1; the result does not depend on it.
Check check_steep(const Grid& grid, const CellMap& map, const Configurations& found,
                  const Forces* forces, const Rendering& rendering, int threads);

}  // namespace hapgrid
