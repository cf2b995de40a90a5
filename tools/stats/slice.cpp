#include "tools/stats/slice.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

Slice slice_levels(const Grid& grid, int axis, double value) {
  const Box& box = grid.box();
  const double last = box.counts[axis] - 1;
  const double plane = (value - box.origin[axis]) / box.spacing;
  // A value typed as the report prints a plane may be off by rounding.
  if (!(plane >= -1e-9 && plane <= last + 1e-9)) {
    throw Error(format("slice {0}={1} is outside the box: {0} goes from {2} to {3}", "xyz"[axis],
                       to_text(value), rounded(box.origin[axis]),
                       rounded(box.origin[axis] + box.spacing * last)));
  }
  const auto nearest =
      static_cast<std::uint32_t>(std::clamp(std::ceil(plane - 0.5 - 1e-9), 0.0, last));
  Slice slice;
  slice.axis = axis;
  slice.u = axis == 0 ? 1 : 0;
  slice.v = axis == 2 ? 1 : 2;
  slice.coordinate = box.origin[axis] + box.spacing * nearest;
  GridCoordinates c{};
  c[axis] = nearest;
  for (c[slice.v] = 0; c[slice.v] < box.counts[slice.v]; ++c[slice.v])
    for (c[slice.u] = 0; c[slice.u] < box.counts[slice.u]; ++c[slice.u])
      slice.levels.push_back(grid.levels(box.index(c)));
  return slice;
}

}  // namespace hapgrid
