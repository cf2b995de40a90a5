// Conversions that were made one at a time are asked for again: several at a time, and in two
// threads that ask two models at once, as expand -j 2 does.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// A conversion that was made alone.
struct Made {
  PointIndex point;
  int q;
  Vec3 x, d;
  std::vector<double> from;  ///< a state
  std::vector<double> row;   ///< what C has given
};

/// How a row differs from what was made, in words that begin with a comma; empty where it is the
/// same.
using Difference = std::function<std::string(const Made&, std::span<const double> row)>;

/// Asks the model for all of `made`, a process for several at a time, until the time is over.
/// Offenders are answers that differ, and failures.
/// @param text_of says which conversion it is
Findings ask_at_a_time(Model& model, std::span<const Made> made, double seconds,
                       const Difference& difference,
                       const std::function<std::string(const Made&)>& text_of);

/// Asks both models for all of `made`, each in a thread of its own, a process for several at a
/// time, as above. A plug-in that crashes meanwhile ends the program with a line that says so
/// (search/converter.hpp).
Findings ask_together(Model& one, Model& other, std::span<const Made> made, double seconds,
                      const Difference& difference,
                      const std::function<std::string(const Made&)>& text_of);

}  // namespace hapgrid
