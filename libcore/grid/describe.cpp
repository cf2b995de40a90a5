#include "libcore/grid/describe.hpp"

#include <charconv>

namespace hapgrid {

std::string describe(const Box& box, PointIndex point) {
  const GridCoordinates c = box.coordinates(point);
  return "point " + std::to_string(point) + " (" + std::to_string(c[0]) + ", " +
         std::to_string(c[1]) + ", " + std::to_string(c[2]) + ")";
}

std::string describe(const Box& box, PointIndex point, Level level) {
  return describe(box, point) + " level " + std::to_string(level);
}

std::string to_text(double value) {
  char buffer[32];
  const auto result = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, result.ptr);
}

}  // namespace hapgrid
