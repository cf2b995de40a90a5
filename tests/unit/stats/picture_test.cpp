// What the pictures of stats are drawn from.
#include <catch2/catch.hpp>
#include <sstream>

#include "libcore/base/error.hpp"
#include "tests/unit/check/tiny_grid.hpp"
#include "tools/stats/motion_log.hpp"
#include "tools/stats/slice.hpp"

using namespace hapgrid;

namespace {

std::vector<XY> read(const std::string& text) {
  std::istringstream log(text);
  return read_log(log, "p.log", "x", {"s0"}).at(0);
}

}  // namespace

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

TEST_CASE("a slice outside the box is refused") {
  const Grid grid = tiny::grid();
  CHECK_THROWS_WITH(slice_levels(grid, 0, 1.4),
                    "slice x=1.4 is outside the box: x goes from 0.5 to 1.25");
  CHECK_THROWS_AS(slice_levels(grid, 0, 0.49), Error);
  CHECK_THROWS_AS(slice_levels(grid, 2, 0.1), Error);
}

TEST_CASE("columns of a log are found by name") {
  const std::vector<XY> expected{{1, 3}, {-1.5, 4e-3}};
  CHECK(read("# t\tx\ty\ts0\n0\t1\t2\t3\n0.1\t-1.5\t2\t4e-3\n") == expected);
  CHECK(read("#t\ts0\tx\n0\t3\t1\n0\t4e-3\t-1.5") == expected);
}

TEST_CASE("a malformed log is named with its line") {
  CHECK_THROWS_WITH(read(""),
                    "p.log: line 1: no '#' and names of columns, as play --log writes them");
  CHECK_THROWS_WITH(read("0\t1\n"),
                    "p.log: line 1: no '#' and names of columns, as play --log writes them");
  CHECK_THROWS_WITH(read("# t\tx\n"), "p.log: line 1: no column 's0' in: t x");
  CHECK_THROWS_WITH(read("# x\ts0\n"), "p.log: line 1: no ticks after the names of the columns");
  CHECK_THROWS_WITH(read("# x\ts0\n1\t2\n1\n"), "p.log: line 3: 1 columns instead of 2");
  CHECK_THROWS_WITH(read("# x\ts0\n1\t2\t3\n"), "p.log: line 2: 3 columns instead of 2");
  CHECK_THROWS_WITH(read("# x\ts0\n1\tword\n"),
                    "p.log: line 2: column s0: 'word' is no finite number");
  CHECK_THROWS_WITH(read("# x\ts0\n1,5\t1\n"),
                    "p.log: line 2: column x: '1,5' is no finite number");
  CHECK_THROWS_AS(read("# x\ts0\nnan\t1\n"), Error);
  CHECK_THROWS_AS(read("# x\ts0\n\t1\n"), Error);
}

TEST_CASE("several columns are read at once") {
  std::istringstream log("# x\ta\tb\n1\t2\t3\n4\t5\t6\n");
  const std::vector<std::vector<XY>> expected{{{1, 3}, {4, 6}}, {{1, 2}, {4, 5}}};
  CHECK(read_log(log, "p.log", "x", {"b", "a"}) == expected);
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
