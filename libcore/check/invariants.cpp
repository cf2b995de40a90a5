#include "libcore/check/invariants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "libcore/base/parallel.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/describe.hpp"

namespace hapgrid {

namespace {

constexpr std::uint64_t kPointBlock = 1 << 12;

/// What is wrong with one destination level, empty when nothing is.
/// @param inside whether the direction stays in the box
std::string link_fault(const Grid& grid, RecordIndex r, int q, bool inside) {
  const Level level = grid.links(r)[q];
  const std::string shown = "destination level " + std::to_string(level);
  if (!inside) return level == kLeavesBox ? "" : shown + ", but the direction leaves the box";
  if (level == kLeavesBox) return "marked as leaving the box, but it stays inside";
  if (grid.in_frontier(r))
    return level == kUnsettled ? "" : shown + ", but the record is in the frontier";
  if (level == kUnsettled) return "not settled, but the record is not in the frontier";
  const auto target = static_cast<PointIndex>(grid.point(r) + grid.neighbourhood().offset(q));
  if (level < grid.levels(target)) return "";
  return shown + ", but " + describe(grid.box(), target) + " has " +
         std::to_string(grid.levels(target)) + " levels";
}

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

template <class LookAt>
Findings for_each_record(const Grid& grid, int threads, const LookAt& look_at) {
  return for_each_point(grid, threads, [&](PointIndex p, Findings& found) {
    for (RecordIndex r = grid.first(p); r < grid.first(p) + grid.levels(p); ++r) look_at(r, found);
  });
}

}  // namespace

Check check_complete(const Grid& grid, int threads) {
  Check check{"complete", "records", "records that no expand has looked at (the frontier)", {}};
  check.found = for_each_record(grid, threads, [&](RecordIndex r, Findings& found) {
    ++found.counted;
    if (grid.in_frontier(r)) found.offend(place_of(grid, r), [&] { return describe(grid, r); });
  });
  return check;
}

Check check_coverage(const Grid& grid, int threads) {
  Check check{"coverage", "points", "points without a level", {}};
  check.found = for_each_point(grid, threads, [&](PointIndex p, Findings& found) {
    ++found.counted;
    if (grid.levels(p) == 0) found.offend({p, {}, {}}, [&] { return describe(grid.box(), p); });
  });
  return check;
}

Check check_links(const Grid& grid, int threads) {
  Check check{"links", "directions", "destination levels that cannot be", {}};
  check.found = for_each_record(grid, threads, [&](RecordIndex r, Findings& found) {
    found.counted += kDirections;
    const DirectionMask inside = grid.neighbourhood().inside(grid.point(r));
    const auto links = grid.links(r);
    for (int q = 0; q < kDirections; ++q) {
      const bool is_inside = inside >> q & 1;
      // The ordinary case without strings: this loop runs 26 times for each record.
      if (!is_inside && links[q] == kLeavesBox) continue;
      if (is_inside && !grid.in_frontier(r) && links[q] < kMaxLevels &&
          links[q] <
              grid.levels(static_cast<PointIndex>(grid.point(r) + grid.neighbourhood().offset(q))))
        continue;
      const std::string fault = link_fault(grid, r, q, is_inside);
      if (!fault.empty())
        found.offend(place_of(grid, r, q),
                     [&] { return describe_link(grid, r, q) + ": " + fault; });
    }
  });
  return check;
}

bool is_finite(std::span<const double> state) {
  return std::all_of(state.begin(), state.end(), [](double v) { return std::isfinite(v); });
}

Check check_finite(const Grid& grid, int threads) {
  Check check{"finite", "records", "rows with a number that is not finite", {}};
  check.found = for_each_record(grid, threads, [&](RecordIndex r, Findings& found) {
    ++found.counted;
    if (is_finite(grid.row(r))) return;
    found.offend(place_of(grid, r), [&] {
      const auto row = grid.row(r);
      const auto bad =
          std::find_if_not(row.begin(), row.end(), [](double v) { return std::isfinite(v); });
      const auto index = static_cast<std::size_t>(bad - row.begin());
      const bool in_state = index < grid.state_size();
      return describe(grid, r) + ": " + (in_state ? "component " : "stored number ") +
             std::to_string(in_state ? index : index - grid.state_size()) + " is " + to_text(*bad);
    });
  });
  return check;
}

Check check_distinct(const Grid& grid, const SameState& same) {
  Check check{"distinct",
              "pairs of levels",
              "levels of one point that are the same state under the tolerance function",
              {}};
  for (std::uint64_t p = 0; p < grid.box().points(); ++p) {
    const RecordIndex begin = grid.first(static_cast<PointIndex>(p));
    const RecordIndex end = begin + grid.levels(static_cast<PointIndex>(p));
    for (RecordIndex a = begin; a < end; ++a)
      for (RecordIndex b = a + 1; b < end; ++b) {
        ++check.found.counted;
        if (!is_finite(grid.state(a)) || !is_finite(grid.state(b))) continue;
        if (!same(grid.state(a).data(), grid.state(b).data())) continue;
        check.found.offend(place_of(grid, a), [&] {
          return describe(grid, a) + " and level " + std::to_string(grid.level(b)) + ": states " +
                 state_text(grid.state(a)) + " and " + state_text(grid.state(b));
        });
      }
  }
  return check;
}

std::vector<Check> check_reachable(const Grid& grid) {
  Check reachable{
      "reachable", "records", "records that no chain of links leads to from the seeds", {}};
  Check generations{"generations",
                    "records",
                    "records whose generation is not their distance from the seeds, in links, or "
                    "less than that of a level below",
                    {}};
  constexpr std::uint32_t kUnreached = ~std::uint32_t{0};
  std::vector<std::uint32_t> distance(grid.records(), kUnreached);
  // Breadth first: `reached` is the queue, and keeps what has left it.
  std::vector<RecordIndex> reached;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (grid.record_generation(r) != 0) continue;
    distance[r] = 0;
    reached.push_back(r);
  }
  for (std::size_t head = 0; head < reached.size(); ++head) {
    const RecordIndex r = reached[head];
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex target = grid.destination(r, q);
      if (target == Grid::kNoRecord || distance[target] != kUnreached) continue;
      distance[target] = distance[r] + 1;
      reached.push_back(target);
    }
  }
  reachable.found.counted = grid.records();
  generations.found.counted = reached.size();
  std::uint32_t youngest = 0;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (distance[r] == kUnreached) {
      reachable.found.offend(place_of(grid, r), [&] { return describe(grid, r); });
    } else if (distance[r] != grid.record_generation(r)) {
      generations.found.offend(place_of(grid, r), [&] {
        return describe(grid, r) + ": generation " + std::to_string(grid.record_generation(r)) +
               ", distance " + std::to_string(distance[r]);
      });
    } else if (r > 0 && grid.point(r - 1) == grid.point(r) &&
               grid.record_generation(r - 1) > grid.record_generation(r)) {
      // Play starts at level 0: the numbers of levels, by when they were found, matter.
      generations.found.offend(place_of(grid, r), [&] {
        return describe(grid, r) + ": generation " + std::to_string(grid.record_generation(r)) +
               ", the level below has " + std::to_string(grid.record_generation(r - 1));
      });
    }
    youngest = std::max(youngest, grid.record_generation(r));
  }
  // The last round finds nothing new.
  if (grid.records() > 0 && grid.generation() > youngest + 1)
    generations.found.offend([&] {
      return "the grid has generation " + std::to_string(grid.generation()) +
             ", its youngest record " + std::to_string(youngest);
    });
  return {std::move(reachable), std::move(generations)};
}

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
