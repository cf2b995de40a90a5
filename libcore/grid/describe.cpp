#include "libcore/grid/describe.hpp"

namespace hapgrid {

std::string describe(const Box& box, PointIndex point) {
  const GridCoordinates c = box.coordinates(point);
  return "point " + std::to_string(point) + " (" + std::to_string(c[0]) + ", " +
         std::to_string(c[1]) + ", " + std::to_string(c[2]) + ")";
}

std::string describe(const Box& box, PointIndex point, Level level) {
  return describe(box, point) + " level " + std::to_string(level);
}

}  // namespace hapgrid
