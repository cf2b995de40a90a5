// Sets of a box's points, a bit each, and the points at which something can be that most points of
// a grid do not have.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "libcore/base/parallel.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// The set and all neighbours of its points. Points at the sides of the box may be in it besides.
PointBits grown(PointBits bits, const Box& box);

/// Points around which links need a look: all others, and their 26 neighbours, are *parallel*. The
/// links of a parallel point's record lead to its own level number in all directions, so that links
/// between parallel points lead back to where they come from, or lead nowhere. Grid::tangled() has
/// them.
/// @param threads at least 1; the result does not depend on it.
PointBits tangled_points(const Grid& grid, int threads);

/// Whether a point is parallel.
bool is_parallel(const Grid& grid, PointIndex p);

/// Cuts the set into blocks, lets work(p, result) look at each of its points in ascending order, in
/// threads, and joins the results by sum.add(result), whatever the number of threads.
template <class Result, class Work>
Result sum_of_points(const PointBits& bits, int threads, const Work& work) {
  constexpr std::uint64_t kWords = 256;
  return sum_of_blocks<Result>(
      bits.size(), kWords, threads, [&](std::uint64_t begin, std::uint64_t end) {
        Result result;
        for (std::uint64_t w = begin; w < end; ++w)
          for (std::uint64_t left = bits[w]; left != 0; left &= left - 1)
            work(static_cast<PointIndex>(w * 64 + static_cast<unsigned>(std::countr_zero(left))),
                 result);
        return result;
      });
}

}  // namespace hapgrid
