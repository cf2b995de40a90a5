// The paper's rule for a switch to another cell (libcore/grid/cell.hpp): whatever the levels and
// the links are, each vertex that both cells have keeps its record. So the interpolated state is
// continuous on the face, edge or vertex between them, where the other corners have no weight.
#include <array>
#include <catch2/catch.hpp>

#include "libcore/grid/cell.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

struct Kept {
  std::uint64_t switches = 0, corners = 0;
};

/// Goes from each cell, with random levels in its corners, to each cell beside it.
Kept switch_everywhere(const Grid& grid, std::mt19937_64& random) {
  const Cells cells(grid);
  const Box& box = grid.box();
  Kept kept;
  for (PointIndex base = 0; base < box.points(); ++base)
    for (int q = 0; q < kDirections; ++q) {
      const GridCoordinates at = box.coordinates(base);
      const auto step = Direction(q).step();
      GridCoordinates to = at;
      bool exists = true;
      for (int a = 0; a < 3; ++a) {
        to[a] += static_cast<std::uint32_t>(step[a]);
        exists &= at[a] < cells.count(a) && to[a] < cells.count(a);
      }
      if (!exists) continue;
      Corners from, there;
      for (int k = 0; k < 8; ++k) {
        const PointIndex p = cells.point(base, k);
        from.level[k] = static_cast<Level>(random() % grid.levels(p));
        from.record[k] = grid.first(p) + from.level[k];
      }
      bool level_changed = false;
      REQUIRE(cells.cross(q, box.index(to), from, there, level_changed));
      ++kept.switches;
      for (int k = 0; k < 8; ++k) {
        const PointIndex p = cells.point(box.index(to), k);
        REQUIRE(grid.point(there.record[k]) == p);
        for (int j = 0; j < 8; ++j) {
          if (cells.point(base, j) != p) continue;
          CAPTURE(base, q, k, j);
          CHECK(there.record[k] == from.record[j]);
          ++kept.corners;
        }
      }
    }
  return kept;
}

}  // namespace

TEST_CASE("a switch of the paper's rule keeps the records of the vertices that both cells have") {
  std::mt19937_64 random(1);
  const Box box{{0, 0, 0}, 1, {3, 3, 3}};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Kept kept = switch_everywhere(random_grid(box, 1, 2, seed), random);
    // Of 8 cells each has 3 neighbours across faces, 3 across edges and 1 across a vertex.
    CHECK(kept.switches == 8 * 7);
    CHECK(kept.corners == 8 * (3 * 4 + 3 * 2 + 1));
  }
}
