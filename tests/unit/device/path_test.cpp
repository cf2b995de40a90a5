#include "libcore/device/path.hpp"

#include "tests/unit/catch.hpp"

using namespace hapgrid;

TEST_CASE("a path is three numbers a line") {
  // Comments, blank lines, tabs, other systems' line ends, plus signs, no newline at the end.
  for (const char* text :
       {"1 -2.5 3e-3\n0.1 0 -0.0 next\n5e-324 2 3\n",
        "# x y z\r\n\n  1\t-2.5   3e-3 \r\n \t \n.1 +0 -0 next # there\n5e-324 2 +3"}) {
    const std::vector<DeviceInput> ticks = parse_path(text, "p");
    REQUIRE(ticks.size() == 3);
    CHECK(ticks[0].position == Vec3{1, -2.5, 3e-3});
    CHECK(ticks[1].position == Vec3{0.1, 0, -0.0});
    CHECK(ticks[2].position == Vec3{5e-324, 2, 3});
    CHECK((!ticks[0].next && ticks[1].next && !ticks[2].next));
  }
}
