// What the pictures of stats are drawn from.
#include <catch2/catch.hpp>

#include "tests/unit/check/tiny_grid.hpp"
#include "tools/stats/motion_log.hpp"
#include "tools/stats/slice.hpp"

using namespace hapgrid;

TEST_CASE("a slice has the levels of each point of the nearest plane") {
  const Grid grid = tiny::grid();  // planes x = 0.5, 0.75, 1, 1.25
  const Slice z = slice_levels(grid, 2, 0);
  CHECK(z.levels == std::vector<RecordIndex>{1, 2, 2, 1});
  CHECK((z.u == 0 && z.v == 1));
  const Slice x = slice_levels(grid, 0, 0.76);
  CHECK(x.levels == std::vector<RecordIndex>{2});
  CHECK(x.coordinate == 0.75);
  CHECK((x.u == 1 && x.v == 2));
  CHECK(slice_levels(grid, 0, 0.875).coordinate == 0.75);  // the lower of two
  CHECK(slice_levels(grid, 0, 1.25).coordinate == 1.25);
  const Slice y = slice_levels(grid, 1, 0);
  CHECK((y.u == 0 && y.v == 2));
}

TEST_CASE("a slice runs through the right points of a box with three sides") {
  GridSpec spec = tiny::spec();
  spec.box = {{0, 0, 0}, 1, {2, 3, 4}};
  RecordColumns records;  // one level at (1, 2, 3) and (0, 1, 2), two at (1, 0, 2)
  for (const GridCoordinates c : {GridCoordinates{1, 0, 2}, {1, 0, 2}, {0, 1, 2}, {1, 2, 3}}) {
    const PointIndex p = spec.box.index(c);
    const bool again = !records.point.empty() && records.point.back() == p;
    tiny::add(records, p, again ? 1 : 0, 0, again, 0, 0);
  }
  const Grid grid(spec, 0, records);
  CHECK(slice_levels(grid, 2, 2).levels == std::vector<RecordIndex>{0, 2, 1, 0, 0, 0});
  CHECK(slice_levels(grid, 1, 0).levels == std::vector<RecordIndex>{0, 0, 0, 0, 0, 2, 0, 0});
  CHECK(slice_levels(grid, 0, 1).levels ==
        std::vector<RecordIndex>{0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1});
}

TEST_CASE("there and back follow time: the farthest place from the start is where back begins") {
  using Line = std::vector<XY>;
  const auto check = [](const Line& ticks, const Line& there, const Line& back) {
    const Motion motion = split_motion(ticks);
    CHECK(motion.there == there);
    CHECK(motion.back == back);
  };
  check({{0, 0}, {1, 1}, {0, 2}}, {{0, 0}, {1, 1}}, {{1, 1}, {0, 2}});
  // The way there may run to the left, and may turn on the way.
  check({{0, 0}, {-2, 1}, {-1, 2}, {-3, 3}, {0, 4}}, {{0, 0}, {-2, 1}, {-1, 2}, {-3, 3}},
        {{-3, 3}, {0, 4}});
  // A rest at the farthest place is on the way back.
  check({{0, 0}, {1, 1}, {1, 5}, {0, 2}}, {{0, 0}, {1, 1}}, {{1, 1}, {1, 5}, {0, 2}});
  check({{0, 0}, {1, 1}}, {{0, 0}, {1, 1}}, {});
  check({{1, 2}}, {{1, 2}}, {});
}
