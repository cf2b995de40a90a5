#include "libcore/grid/box.hpp"

#include "tests/unit/catch.hpp"

using namespace hapgrid;

TEST_CASE("directions ascend through the cube without its centre") {
  int q = 0;
  for (int d3 = -1; d3 <= 1; ++d3)
    for (int d2 = -1; d2 <= 1; ++d2)
      for (int d1 = -1; d1 <= 1; ++d1) {
        if (d1 == 0 && d2 == 0 && d3 == 0) continue;
        CHECK(Direction(q).step() == std::array<int, 3>{d1, d2, d3});
        CHECK(Direction::of(d1, d2, d3).q() == q);
        CHECK(Direction(q).opposite() == Direction::of(-d1, -d2, -d3));
        ++q;
      }
  CHECK(q == kDirections);
}

TEST_CASE("a neighbourhood agrees with coordinates counted by hand") {
  // Counts of 1 and 2 have points on both sides of an axis at once.
  for (const GridCoordinates counts :
       {GridCoordinates{4, 3, 5}, {1, 3, 2}, {2, 1, 1}, {1, 1, 1}, {3, 3, 3}}) {
    const Box box{{0.5, -1, 2}, 0.25, counts};
    const Neighbourhood around(box);
    for (PointIndex p = 0; p < box.points(); ++p) {
      const auto c = box.coordinates(p);
      REQUIRE(box.index(c) == p);
      for (int q = 0; q < kDirections; ++q) {
        bool inside = true;
        GridCoordinates target{};
        for (int a = 0; a < 3; ++a) {
          const std::int64_t t = std::int64_t{c[a]} + Direction(q).step()[a];
          inside &= t >= 0 && t < counts[a];
          target[a] = static_cast<std::uint32_t>(t);
          CHECK(around.shift(q)[a] == 0.25 * Direction(q).step()[a]);
        }
        CHECK(bool(around.inside(p) >> q & 1) == inside);
        if (inside) CHECK(p + around.offset(q) == box.index(target));
      }
    }
  }
}
