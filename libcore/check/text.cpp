#include "libcore/check/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

// Enough for every double in every format used here: fixed notation needs 309 digits before the
// point, a sign, a point, and the few decimals that reports ask for.
using Digits = std::array<char, 400>;

}  // namespace

std::string fixed(double value, int decimals) {
  Digits digits;
  const auto end =
      std::to_chars(digits.begin(), digits.end(), value, std::chars_format::fixed, decimals).ptr;
  return std::string(digits.begin(), end);
}

std::string rounded(double value) {
  Digits digits;
  const auto end =
      std::to_chars(digits.begin(), digits.end(), value, std::chars_format::general, 6).ptr;
  return std::string(digits.begin(), end);
}

std::string printable(std::string_view text) {
  std::string safe(text);
  for (char& c : safe)
    if (c < 0x20 || c > 0x7e) c = '?';
  return safe;
}

std::string state_text(std::span<const double> state) {
  if (state.size() == 1) return to_text(state[0]);
  constexpr std::size_t kShown = 4;
  std::string text = "(";
  for (std::size_t c = 0; c < std::min(state.size(), kShown); ++c)
    text += (c == 0 ? "" : ", ") + to_text(state[c]);
  return text + (state.size() > kShown ? ", ...)" : ")");
}

std::string describe(const Grid& grid, RecordIndex r) {
  return describe(grid.box(), grid.point(r), grid.level(r));
}

std::string describe_link(const Grid& grid, RecordIndex r, int q) {
  const auto step = Direction(q).step();
  return describe(grid, r) + " direction " + std::to_string(q) + " (" + std::to_string(step[0]) +
         ", " + std::to_string(step[1]) + ", " + std::to_string(step[2]) + ")";
}

}  // namespace hapgrid
