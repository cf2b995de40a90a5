// Two columns of what `play --log` wrote, for a picture.
#pragma once

#include <istream>
#include <string>
#include <utility>
#include <vector>

namespace hapgrid {

using XY = std::pair<double, double>;

/// Reads the columns named `x` and `y`, a value a tick, from a tab-separated log whose first line
/// is '#' and the names of the columns.
/// @param name of the log, for messages.
/// @throw Error with the line number when the first line is no such line, a column is not there,
/// a line has another number of columns, or a value is no finite number; when there is no tick.
std::vector<XY> read_log(std::istream& log, const std::string& name, const std::string& x,
                         const std::string& y);

/// The log as polylines by direction of motion: `there` while x rises, `back` while it falls. A
/// step straight up or down goes to the direction before it; neighbouring lines share their end.
struct Motion {
  std::vector<std::vector<XY>> there;
  std::vector<std::vector<XY>> back;
};
Motion split_motion(const std::vector<XY>& ticks);

}  // namespace hapgrid
