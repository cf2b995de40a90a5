#include "libcore/device/path.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/refusal.hpp"

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

TEST_CASE("a number that is none is named with its line") {
  const std::pair<std::string, std::string> cases[] = {
      {"0 0 0\n# c\n0 zero 0\n", "line 3: 'zero' is not a number"},
      {"1 2 3 4", "line 1: more than the 3 numbers x y z"},
      {"1 2 3 next 4", "line 1: more than the 3 numbers x y z"},
      {"1 2 next", "line 1: 'next' is not a number"},
      {"0 0\n", "line 1: the 3 numbers x y z are needed, found 2"},
      {"0 0 inf\n", "line 1: 'inf' is not finite"},
      {"", "no position in it"},
      {"1,5 2 3", "line 1: '1,5' is not a number"},
      {"1 2 1e999", "line 1: '1e999' is beyond double precision"},
      {"1 2 +-3", "line 1: '+-3' is not a number"},
      {"1 2 0x10", "line 1: '0x10' is not a number"},
      {std::string("1 2 3\0", 6), "line 1: '3 ' is not a number"}};
  for (const auto& wrong : cases)
    CHECK(testing::refusal([&] { parse_path(wrong.first, "p.txt"); }) == "p.txt: " + wrong.second);
}
