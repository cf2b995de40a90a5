#include "tools/common/spelling.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace hapgrid {

namespace {

/// How many letters have to be put in, left out or replaced to make the one of the other.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t before = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = before + (a[i - 1] != b[j - 1]);
      before = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, replaced}));
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::size_t> nearest(const std::string& word, const std::vector<std::string>& known) {
  std::optional<std::size_t> found;
  std::size_t least = 3;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (const std::size_t far = edits(word, known[i]); far < least) {
      least = far;
      found = i;
    }
  return found;
}

}  // namespace hapgrid
