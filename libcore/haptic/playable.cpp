#include "libcore/haptic/playable.hpp"

#include <algorithm>
#include <array>

#include "libcore/base/error.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/grid/point_bits.hpp"

namespace hapgrid {

namespace {

struct Faults {
  std::uint64_t without_level = 0, broken = 0;

  void add(const Faults& other) {
    without_level += other.without_level;
    broken += other.broken;
  }
};

/// How many links lead to levels that do not exist. Links to level 0 are not looked at: where that
/// is missing, the point has no level at all.
std::uint64_t broken_links(const Grid& grid, PointIndex p) {
  const RecordIndex begin = grid.first(p), end = begin + grid.levels(p);
  RecordIndex r = begin;
  while (r < end && grid.links_lead_to(r, 0)) ++r;
  if (r == end) return 0;
  const Neighbourhood& around = grid.neighbourhood();
  const DirectionMask inside = around.inside(p);
  std::array<RecordIndex, kDirections> levels{};
  for (int q = 0; q < kDirections; ++q)
    if (inside >> q & 1) levels[q] = grid.levels(static_cast<PointIndex>(p + around.offset(q)));
  std::uint64_t broken = 0;
  for (; r < end; ++r) {
    const auto links = grid.links(r);
    for (int q = 0; q < kDirections; ++q)
      if (inside >> q & 1) broken += links[q] >= levels[q];
  }
  return broken;
}

/// Of the 64 points from 64 b on. @param tangled those whose links want a look even if they have
/// one level
Faults faults_of(const Grid& grid, std::uint64_t tangled, std::uint64_t b) {
  Faults faults;
  if (tangled == 0 && grid.is_single(b)) return faults;
  const std::uint64_t end = std::min(grid.box().points(), (b + 1) * 64);
  for (std::uint64_t point = b * 64; point < end; ++point) {
    const auto p = static_cast<PointIndex>(point);
    faults.without_level += grid.levels(p) == 0;
    if (grid.levels(p) > 1 || (tangled >> point % 64 & 1)) faults.broken += broken_links(grid, p);
  }
  return faults;
}

}  // namespace

void require_playable(const Grid& grid, const std::string& name) {
  const PointBits& tangled = grid.tangled();
  const auto [without_level, broken] = sum_of_blocks<Faults>(
      tangled.size(), 64, all_threads(), [&](std::uint64_t begin, std::uint64_t end) {
        Faults faults;
        for (std::uint64_t b = begin; b < end; ++b) faults.add(faults_of(grid, tangled[b], b));
        return faults;
      });
  const auto refuse = [&](std::uint64_t count, const std::string& what) {
    if (count != 0) throw Error(name + ": " + std::to_string(count) + what);
  };
  refuse(grid.frontier(),
         " records are still in the frontier: finish the grid with expand --complete");
  refuse(without_level, " grid points have no level: the seeds do not reach them, see verify");
  refuse(broken, " links lead to no record: the grid is damaged, see verify");
  refuse(grid.not_finite(), " records have a state, force or shape that is not finite, see verify");
}

}  // namespace hapgrid
