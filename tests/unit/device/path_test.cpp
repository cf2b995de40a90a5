#include "libcore/device/path.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/refusal.hpp"

using namespace hapgrid;

TEST_CASE("a path is three numbers a line") {
  const std::vector<PathTick> expected{{{1, -2.5, 3e-3}}, {{0.1, 0, -0.0}, true}, {{5e-324, 2, 3}}};
  CHECK(parse_path("1 -2.5 3e-3\n0.1 0 -0.0 next\n5e-324 2 3\n", "p") == expected);
  // Comments, blank lines, tabs, other systems' line ends, plus signs, no newline at the end.
  CHECK(parse_path("# x y z\r\n\n  1\t-2.5   3e-3 \r\n \t \n.1 +0 -0 next # there\n5e-324 2 +3",
                   "p") == expected);
}

TEST_CASE("a number that is none is named with its line") {
  const std::pair<std::string, std::string> cases[] = {
      {"0 0 0\n# c\n0 zero 0\n", "line 3: 'zero' is not a number"},
      {"1 2 3 4", "line 1: more than the 3 numbers x y z"},
      {"1 2 3 next 4", "line 1: more than the 3 numbers x y z"},
      {"1 2 next", "line 1: 'next' is not a number"},
      {"1,5 2 3", "line 1: '1,5' is not a number"},
      {"1 2 1e999", "line 1: '1e999' is beyond double precision"},
      {"1 2 +-3", "line 1: '+-3' is not a number"},
      {"1 2 0x10", "line 1: '0x10' is not a number"},
      {std::string("1 2 3\0", 6), "line 1: '3 ' is not a number"}};
  for (const auto& wrong : cases)
    CHECK(testing::refusal([&] { parse_path(wrong.first, "p.txt"); }) == "p.txt: " + wrong.second);
}
