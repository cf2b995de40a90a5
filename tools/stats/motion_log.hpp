// Two columns of a text that `play --log` wrote, for a picture.
#pragma once

#include <istream>
#include <string>
#include <utility>
#include <vector>

namespace hapgrid {

using XY = std::pair<double, double>;

/// Reads the columns `y` over the column named `x`, a value for each tick, from a tab-separated log
/// whose first line is '#' and the names of the columns.
/// @param name of the log, for messages. @param beside a column that is read after those of `y` if
/// the log has it. @return the ticks of each column
/// @throw Error with the line number when the first line has no such names, a column is missing, a
/// line has another number of columns, or a value is no finite number; when there is no tick.
std::vector<std::vector<XY>> read_log(std::istream& log, const std::string& name,
                                      const std::string& x, const std::vector<std::string>& y,
                                      const std::string& beside = "");

/// The log as two curves in the order of time: the way there, until x is the farthest from its
/// first value for the first time, and the way back from that tick on. Both have that tick; without
/// a way back `back` is empty.
struct Motion {
  std::vector<XY> there;
  std::vector<XY> back;
};
Motion split_motion(const std::vector<XY>& ticks);

}  // namespace hapgrid
