// Two threads ask two models at once, as expand -j 2 does.
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

/// Asks both models for all of `made`, each in a thread of its own, a process for several at a
/// time, until the time is over. Offenders are answers that differ from those made alone, by
/// is_same(row, row), and failures. A plug-in that crashes meanwhile ends the program with a line
/// that says so (search/converter.hpp).
/// @param text_of says which conversion it is
Findings ask_together(
    Model& one, Model& other, std::span<const Made> made, double seconds,
    const std::function<bool(std::span<const double>, std::span<const double>)>& is_same,
    const std::function<std::string(const Made&)>& text_of);

}  // namespace hapgrid
