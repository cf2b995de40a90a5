// What the search of a grid would cost, from a sample of its records.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "libcore/model/model.hpp"

namespace hapgrid {

struct GridEstimate {
  double levels = 1;                   ///< a point
  std::uint64_t conversions = 0;       ///< of the rounds
  std::uint64_t tear_conversions = 0;  ///< of the round of tear fractions; 0 without them
  double cpu_seconds = 0;              ///< of both; of a process it is the time until it answers
  std::uint64_t play_bytes = 0;        ///< of the grid in memory
  std::uint64_t expand_bytes = 0;      ///< of the requests around the frontier
};

struct EstimateLimits {
  double seconds = 5;      ///< for all of it; CPU time of a plug-in
  std::uint64_t seed = 1;  ///< another one takes the records in another order
};

/// Searches a coarser grid of the same box, then finer ones while there is time. The last one says
/// how many levels a point has, and how many bisections there are for a conversion. What a
/// conversion takes is measured at its records, with the shifts of the whole grid.
/// @param seeds by point the states known there, row after row; at least one
/// @param seconds_a_conversion is taken where the time is too short for a single record
GridEstimate estimate_grid(const GridSpec& spec,
                           const std::map<PointIndex, std::vector<double>>& seeds, Model& model,
                           const EstimateLimits& limits, double seconds_a_conversion);

}  // namespace hapgrid
