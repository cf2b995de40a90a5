// One plane of a grid, for a picture.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// The number of levels of each point in a plane across `axis`. The other two axes are u < v.
struct Slice {
  int axis = 2;  ///< 0, 1, 2 for x, y, z
  int u = 0;
  int v = 1;
  double coordinate = 0;            ///< where the plane is, in the model's unit of length
  std::vector<RecordIndex> levels;  ///< counts[u] x counts[v], u fastest; 0: not reached
};

/// The grid plane nearest to `value` on `axis`, the lower of two that are equally near.
/// @throw Error when the value is outside the box (by more than 1e-9 of the spacing).
Slice slice_levels(const Grid& grid, int axis, double value);

}  // namespace hapgrid
