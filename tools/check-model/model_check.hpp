// Tries a model before its grid is searched: the conditions of Sect. 2.1 and the assumptions of
// Algorithms 1 and 2, in states along walks through the box.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/model/model.hpp"
#include "tools/check-model/call_times.hpp"

namespace hapgrid {

struct ModelCheck {
  std::vector<Check> checks;
  double start_seconds = 0;  ///< until a model answers, and what only its first conversions take
  CallTimes convert;
  CallTimes force;  ///< without calls when the model has no force or the grid stores it
  CallTimes shape;
  /// Median error of the force's nonzero components against the energy's gradient, as a share of
  /// the largest force.
  double median_force_error = 0;
  double largest_force = 0;  ///< newtons
};

/// Walks from random seeds to random points of the box, straight on, one grid step after the other,
/// as a hand would, and tries the model at each step.
/// @param make_model two are made, to compare them.
/// @param most_steps along the walks. @param most_seconds no step begins after this time.
/// @param seeds by point the states known there, row after row; at least one.
/// @throw ModelError when a model cannot be made.
ModelCheck check_model(const GridSpec& spec, const std::map<PointIndex, std::vector<double>>& seeds,
                       const MakeModel& make_model, std::uint64_t most_steps, double most_seconds);

}  // namespace hapgrid
