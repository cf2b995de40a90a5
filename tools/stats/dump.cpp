#include "tools/stats/dump.hpp"

#include "libcore/base/text.hpp"

namespace hapgrid {

std::string dump_header(const Grid& grid) {
  std::string text = "# i\tj\tk\tlevel";
  for (std::uint32_t c = 0; c < grid.state_size(); ++c) text += "\ts" + std::to_string(c);
  for (int q = 0; q < kDirections; ++q) text += "\td" + std::to_string(q);
  return text + '\n';
}

void append_record(std::string& text, const Grid& grid, RecordIndex r) {
  for (const std::uint32_t c : grid.box().coordinates(grid.point(r)))
    text += std::to_string(c) + '\t';
  text += std::to_string(grid.level(r));
  for (const double value : grid.state(r)) {
    text += '\t';
    append_digits17(text, value);
  }
  for (const Level level : grid.links(r)) {
    text += '\t';
    if (level == kLeavesBox)
      text += '-';
    else if (level == kUnsettled)
      text += '?';
    else
      text += std::to_string(level);
  }
  text += '\n';
}

}  // namespace hapgrid
