// How a hand goes straight on from one grid point to another.
#pragma once

#include <array>

#include "libcore/grid/box.hpp"
#include "libcore/grid/direction.hpp"

namespace hapgrid {

/// The direction of the next step; the points differ.
inline int direction_to(const Box& box, PointIndex from, PointIndex to) {
  const GridCoordinates a = box.coordinates(from), b = box.coordinates(to);
  std::array<int, 3> d{};
  for (int i = 0; i < 3; ++i) d[i] = b[i] > a[i] ? 1 : b[i] < a[i] ? -1 : 0;
  return Direction::of(d[0], d[1], d[2]).q();
}

}  // namespace hapgrid
