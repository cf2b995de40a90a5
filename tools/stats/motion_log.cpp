#include "tools/stats/motion_log.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t tab = line.find('\t');
    cells.push_back(line.substr(0, tab));
    if (tab == std::string_view::npos) return cells;
    line.remove_prefix(tab + 1);
  }
}

}  // namespace

std::vector<std::vector<XY>> read_log(std::istream& log, const std::string& name,
                                      const std::string& x, const std::vector<std::string>& y,
                                      const std::string& beside) {
  std::size_t number = 1;
  const auto fail = [&](const std::string& what) {
    throw Error(format("{}: line {}: {}", name, number, what));
  };
  std::string line;
  if (!std::getline(log, line) || line.empty() || line[0] != '#')
    fail("no '#' and names of columns, as play --log writes them");
  std::string_view header = std::string_view(line).substr(1);
  if (!header.empty() && header[0] == ' ') header.remove_prefix(1);
  const std::vector<std::string_view> names = split(header);
  const auto column = [&](const std::string& which) {
    const auto found = std::find(names.begin(), names.end(), which);
    if (found == names.end()) fail(format("no column '{}' in: {}", which, printable_line(header)));
    return static_cast<std::size_t>(found - names.begin());
  };
  const std::size_t x_column = column(x);
  std::vector<std::size_t> y_columns;
  y_columns.reserve(y.size());
  for (const std::string& each : y) y_columns.push_back(column(each));
  std::vector<std::string> wanted = y;
  if (!beside.empty() && std::find(names.begin(), names.end(), beside) != names.end()) {
    wanted.push_back(beside);
    y_columns.push_back(column(beside));
  }
  const std::size_t columns = names.size();

  std::vector<std::vector<XY>> ticks(wanted.size());
  while (std::getline(log, line)) {
    ++number;
    const std::vector<std::string_view> cells = split(line);
    if (cells.size() != columns) fail(format("{} columns instead of {}", cells.size(), columns));
    const auto value = [&](std::size_t c, const std::string& column_name) {
      double result = 0;
      const char* end = cells[c].data() + cells[c].size();
      const auto read = std::from_chars(cells[c].data(), end, result);
      if (read.ec != std::errc() || read.ptr != end || !std::isfinite(result))
        fail(format("column {}: '{}' is no finite number", column_name,
                    printable_line(cells[c], 40)));
      return result;
    };
    const double at = value(x_column, x);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      ticks[i].emplace_back(at, value(y_columns[i], wanted[i]));
  }
  if (log.bad()) throw Error(format("{}: cannot be read", name));
  if (number == 1) fail("no ticks after the names of the columns");
  return ticks;
}

Motion split_motion(const std::vector<XY>& ticks) {
  const auto way = [&](const XY& tick) { return std::abs(tick.first - ticks.front().first); };
  const auto turn = std::max_element(ticks.begin(), ticks.end(),
                                     [&](const XY& a, const XY& b) { return way(a) < way(b); });
  Motion motion{{ticks.begin(), turn + 1}, {}};
  if (turn + 1 != ticks.end()) motion.back.assign(turn, ticks.end());
  return motion;
}

}  // namespace hapgrid
