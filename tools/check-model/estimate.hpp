// The cost of the search of a grid, estimated by the search of a coarser one.
#pragma once

#include <cstdint>

#include "libcore/model/definition.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// An amount, and between which two it most likely is.
struct Range {
  double value = 0, least = 0, most = 0;
};

struct GridEstimate {
  Range levels;  ///< a point
  std::uint64_t conversions = 0;
  Range cpu_seconds;               ///< on one core
  std::uint64_t play_bytes = 0;    ///< of the grid in memory
  std::uint64_t expand_bytes = 0;  ///< of the requests around the frontier
  std::uint64_t points = 0;        ///< of the finest grid that was searched for this
  std::uint64_t searched = 0;      ///< conversions of all of these searches
};

/// Searches a coarse grid in the same box, then finer ones while there is time. The last one that
/// ended gives the levels of a point. Their range is twice what they changed by from the grid
/// before, to either side, and at least what the number of points leaves open; of a single coarse
/// grid it is a factor of 3. The range of the time also has the spread of the conversions.
/// @param seconds the time for all searches, from when the model has started
/// @param conversion of a step of the whole grid, in seconds
/// @throw Error, ModelError when a search fails, or none ended in this time
GridEstimate estimate_grid(const Definition& definition, const ModelSource& source, double seconds,
                           const Range& conversion);

}  // namespace hapgrid
