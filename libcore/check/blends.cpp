#include "libcore/check/blends.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "libcore/base/parallel.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kPointBlock = 1 << 12;

/// Whether the record that each corner of a cell gets from the destination levels of `start` has
/// links to the same records. The corners are those that the box has: fewer than eight where an
/// axis has one plane.
bool is_blend(const Grid& grid, RecordIndex start, const GridCoordinates& cell,
              const GridCoordinates& size) {
  struct Corner {
    std::array<int, 3> at;
    RecordIndex record;
  };
  std::array<Corner, 8> corners;
  std::size_t count = 0;
  const auto from = grid.box().coordinates(grid.point(start));
  for (std::uint32_t k = 0; k < size[2]; ++k)
    for (std::uint32_t j = 0; j < size[1]; ++j)
      for (std::uint32_t i = 0; i < size[0]; ++i) {
        const std::array<int, 3> at{static_cast<int>(i), static_cast<int>(j), static_cast<int>(k)};
        std::array<int, 3> step;
        for (int a = 0; a < 3; ++a)
          step[a] = at[a] - (static_cast<int>(from[a]) - static_cast<int>(cell[a]));
        const bool is_start = step == std::array<int, 3>{0, 0, 0};
        const RecordIndex record =
            is_start ? start
                     : grid.destination(start, Direction::of(step[0], step[1], step[2]).q());
        if (record == Grid::kNoRecord) return false;  // not settled: nothing to judge yet
        corners[count++] = {at, record};
      }
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < count; ++b) {
      if (a == b) continue;
      const Direction towards =
          Direction::of(corners[b].at[0] - corners[a].at[0], corners[b].at[1] - corners[a].at[1],
                        corners[b].at[2] - corners[a].at[2]);
      const RecordIndex reached = grid.destination(corners[a].record, towards.q());
      if (reached != Grid::kNoRecord && reached != corners[b].record) return true;
    }
  return false;
}

/// Looks at the grid's points, block by block in threads.
template <class LookAt>
Findings for_each_point(const Grid& grid, int threads, const LookAt& look_at) {
  return sum_of_blocks<Findings>(grid.box().points(), kPointBlock, threads,
                                 [&](std::uint64_t begin, std::uint64_t end) {
                                   Findings found;
                                   for (std::uint64_t p = begin; p < end; ++p)
                                     look_at(static_cast<PointIndex>(p), found);
                                   return found;
                                 });
}

}  // namespace

Check check_blends(const Grid& grid, int threads) {
  Check check{"blends", "cells", "cells whose corners can belong to different branches", {}, true};
  const Box& box = grid.box();
  GridCoordinates size;  // corners along each axis
  for (int a = 0; a < 3; ++a) size[a] = std::min(2u, box.counts[a]);
  check.found = for_each_point(grid, threads, [&](PointIndex base, Findings& found) {
    const GridCoordinates cell = box.coordinates(base);
    for (int a = 0; a < 3; ++a)
      if (cell[a] + size[a] > box.counts[a]) return;  // no cell's lowest corner
    ++found.counted;
    std::array<PointIndex, 8> corners;
    std::size_t count = 0;
    bool has_choice = false;  // with one level at each corner nothing can be mixed
    for (std::uint32_t dk = 0; dk < size[2]; ++dk)
      for (std::uint32_t dj = 0; dj < size[1]; ++dj)
        for (std::uint32_t di = 0; di < size[0]; ++di) {
          corners[count] = box.index({cell[0] + di, cell[1] + dj, cell[2] + dk});
          has_choice |= grid.levels(corners[count++]) > 1;
        }
    if (!has_choice) return;
    std::optional<RecordIndex> blend;
    for (std::size_t c = 0; c < count && !blend; ++c)
      for (RecordIndex l = 0; l < grid.levels(corners[c]) && !blend; ++l)
        if (is_blend(grid, grid.first(corners[c]) + l, cell, size))
          blend = grid.first(corners[c]) + l;
    if (!blend) return;
    found.offend(place_of(grid, *blend), [&] {
      return "cell (" + std::to_string(cell[0]) + ", " + std::to_string(cell[1]) + ", " +
             std::to_string(cell[2]) + ") from " + describe(grid, *blend);
    });
  });
  return check;
}

}  // namespace hapgrid
