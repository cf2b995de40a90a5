#include "libcore/follow/playable.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

void require_playable(const Grid& grid, const std::string& name) {
  std::uint64_t frontier = 0, without_level = 0, broken = 0, not_finite = 0;
  const Box& box = grid.box();
  const Neighbourhood& around = grid.neighbourhood();
  for (std::uint64_t point = 0; point < box.points(); ++point) {
    const auto p = static_cast<PointIndex>(point);
    without_level += grid.levels(p) == 0;
    const DirectionMask inside = around.inside(p);
    for (RecordIndex r = grid.first(p); r < grid.first(p) + grid.levels(p); ++r) {
      frontier += grid.in_frontier(r);
      const auto links = grid.links(r);
      // Level 0 is there if the point has a level at all.
      for (int q = 0; q < kDirections; ++q)
        if (links[q] > 0 && (inside >> q & 1))
          broken += links[q] >= grid.levels(static_cast<PointIndex>(p + around.offset(q)));
      const auto row = grid.row(r);
      not_finite += !std::all_of(row.begin(), row.end(), [](double s) { return std::isfinite(s); });
    }
  }
  const auto refuse = [&](std::uint64_t count, const std::string& what) {
    if (count != 0) throw Error(format("{}: {}{}", name, count, what));
  };
  refuse(frontier, " records are still in the frontier: finish the grid with expand --complete");
  refuse(without_level, " grid points have no level: the seeds do not reach them, see verify");
  refuse(broken, " links lead to no record: the grid is damaged, see verify");
  refuse(not_finite, " records have a state, force or shape that is not finite, see verify");
}

}  // namespace hapgrid
