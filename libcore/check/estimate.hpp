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
  std::uint64_t points = 200;  ///< that are looked at
  double seconds = 5;          ///< no further one is begun after them; CPU time of a plug-in
  std::uint64_t seed = 1;      ///< another one draws other points
};

/// Goes to random points of the box by several ways, each from a random seed past another random
/// point, and from there to points nearby and back, so that several of the levels there are met.
/// From each it makes the conversions that the
/// search makes of such a record, and the bisections of those that do not lead back. So what is in
/// contact has the share that it has in the grid.
/// @param seeds by point the states known there, row after row; at least one
/// @param seconds_a_conversion is taken where the time is too short for a single point
GridEstimate estimate_grid(const GridSpec& spec,
                           const std::map<PointIndex, std::vector<double>>& seeds, Model& model,
                           const EstimateLimits& limits, double seconds_a_conversion);

}  // namespace hapgrid
