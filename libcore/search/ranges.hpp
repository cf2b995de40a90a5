// A grid in ranges of points, each a shard of its own, so that no step of a round is serial in the
// size of the grid: expand writes its requests by the range of their target, and each range is
// merged by itself.
//
// A range is whole chunks of a grid, so the ranges' chunks are those of the grid as a whole, and a
// grid that is put together from its ranges has the same bytes, however many they were.
//
// What a range needs of its surroundings: with `reach` the farthest that a direction goes in
// points, the links of its records lead at most reach away, so the levels there must be found, too;
// which takes the requests for these targets, and the records that those came from, another reach
// away.
#pragma once

#include <cstdint>

#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// Points [begin, end).
struct PointRange {
  std::uint64_t begin = 0;
  std::uint64_t end = ~std::uint64_t{0};

  bool holds(std::uint64_t point) const { return begin <= point && point < end; }
  /// By so many points more to both sides.
  PointRange widened(std::uint64_t points) const {
    return {begin > points ? begin - points : 0,
            end + points < end ? ~std::uint64_t{0} : end + points};
  }
};

/// Part `number` (from 1) of `of` ranges of nearly as many chunks each; ranges can be empty where
/// the grid has fewer chunks than `of`. The last one ends behind the last point.
PointRange point_range(const GridSpec& spec, std::uint64_t number, std::uint64_t of);

/// The most ranges, at most `wanted`, of which none is empty.
std::uint64_t range_count(const GridSpec& spec, std::uint64_t wanted);

/// Where the records lie that a range's merge depends on.
PointRange needed_points(const GridSpec& spec, PointRange range);

}  // namespace hapgrid
