// What the model beside the grid says (beside.hpp), for those who do not ask it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// What the model says of the place where the hand will be when this answer comes.
struct BesideAnswer {
  std::uint64_t tick = 0;     ///< Beside::tick() when it was asked
  bool usable = false;        ///< the model could follow the hand
  Vec3 at{0, 0, 0};           ///< that place, in the model's unit of length
  std::vector<double> row;    ///< GridSpec::row_size() values: state, and what is stored
  std::optional<Vec3> force;  ///< newtons; nothing: the model does not say
};

}  // namespace hapgrid
