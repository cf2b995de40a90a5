// Two columns of what `play --log` wrote, for a picture.
#pragma once

#include <istream>
#include <string>
#include <utility>
#include <vector>

namespace hapgrid {

using XY = std::pair<double, double>;

/// Reads the columns `y` over the column named `x`, a value a tick, from a tab-separated log whose
/// first line is '#' and the names of the columns.
/// @param name of the log, for messages. @param beside a column that is read after those of `y`
/// where the log has it. @return the ticks of each column
/// @throw Error with the line number when the first line is no such line, a column is not there,
/// a line has another number of columns, or a value is no finite number; when there is no tick.
std::vector<std::vector<XY>> read_log(std::istream& log, const std::string& name,
                                      const std::string& x, const std::vector<std::string>& y,
                                      const std::string& beside = "");

/// The log as two lines in the order of time: there, until x is the farthest from where it began
/// for the first time, and back, from there on. They share that tick; without a way back `back` is
/// empty.
struct Motion {
  std::vector<XY> there;
  std::vector<XY> back;
};
Motion split_motion(const std::vector<XY>& ticks);

}  // namespace hapgrid
