#include "libcore/grid/describe.hpp"

#include <algorithm>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

std::string describe(const Box& box, PointIndex point) {
  const GridCoordinates c = box.coordinates(point);
  return format("point {} ({}, {}, {})", point, c[0], c[1], c[2]);
}

std::string describe(const Box& box, PointIndex point, Level level) {
  return format("{} level {}", describe(box, point), level);
}

std::string describe(const Grid& grid, RecordIndex r) {
  return describe(grid.box(), grid.point(r), grid.level(r));
}

std::string describe_link(const Grid& grid, RecordIndex r, int q) {
  const auto step = Direction(q).step();
  return format("{} direction {} ({}, {}, {})", describe(grid, r), q, step[0], step[1], step[2]);
}

std::string state_text(std::span<const double> state) {
  if (state.size() == 1) return to_text(state[0]);
  constexpr std::size_t kShown = 4;
  std::string text = "(";
  for (std::size_t c = 0; c < std::min(state.size(), kShown); ++c)
    text += (c == 0 ? "" : ", ") + to_text(state[c]);
  return text + (state.size() > kShown ? ", ...)" : ")");
}

}  // namespace hapgrid
