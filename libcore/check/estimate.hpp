// The cost of the search of a grid, estimated by the search of a coarser one.
#pragma once

#include <cstdint>

#include "libcore/model/definition.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

struct GridEstimate {
  double levels = 1;                   ///< a point
  std::uint64_t conversions = 0;       ///< of the rounds
  std::uint64_t tear_conversions = 0;  ///< of the round of tear fractions; 0 without them
  double cpu_seconds = 0;              ///< of both, on one core
  std::uint64_t play_bytes = 0;        ///< of the grid in memory
  std::uint64_t expand_bytes = 0;      ///< of the requests around the frontier
};

/// Searches a coarse grid in the same box, then finer ones while there is time. The last one gives
/// the levels of a point and the share of conversions for tear fractions. When there is no time for
/// any, the part that was searched stands for the grid. The estimate can be wrong by a factor of 3.
/// @param seconds the time for all searches
/// @param seconds_a_conversion of a step of the whole grid
/// @throw Error, ModelError when a search fails
GridEstimate estimate_grid(const Definition& definition, const ModelSource& source, double seconds,
                           double seconds_a_conversion);

}  // namespace hapgrid
