#include "libcore/device/path.hpp"

#include <catch2/catch.hpp>
#include <fstream>

#include "libcore/base/error.hpp"
#include "tests/unit/haptic/count_allocations.hpp"
#include "tests/unit/refusal.hpp"

using namespace hapgrid;

namespace {

std::string refusal(const std::string& text) {
  return testing::refusal([&] { parse_path(text, "p.txt"); });
}

}  // namespace

TEST_CASE("a path is three numbers a line") {
  const std::vector<Vec3> expected{{1, -2.5, 3e-3}, {0.1, 0, -0.0}, {5e-324, 2, +3}};
  CHECK(parse_path("1 -2.5 3e-3\n0.1 0 -0.0\n5e-324 2 3\n", "p") == expected);
  // Comments, blank lines, tabs, other systems' line ends, plus signs, no newline at the end.
  CHECK(parse_path("# x y z\r\n\n  1\t-2.5   3e-3 \r\n \t \n.1 +0 -0 # there\n5e-324 2 +3", "p") ==
        expected);
}

TEST_CASE("a wrong line is named") {
  CHECK(refusal("0 0 0\n# c\n0 zero 0\n") == "p.txt: line 3: 'zero' is not a number");
  CHECK(refusal("0 0 0\n\n1 2\n") == "p.txt: line 3: the 3 numbers x y z are needed, found 2");
  CHECK(refusal("1 2 3 4") == "p.txt: line 1: more than the 3 numbers x y z");
  CHECK(refusal("1 2 3x") == "p.txt: line 1: '3x' is not a number");
  CHECK(refusal("1,5 2 3") == "p.txt: line 1: '1,5' is not a number");
  CHECK(refusal("1 nan 3") == "p.txt: line 1: 'nan' is not finite");
  CHECK(refusal("1 2 -inf") == "p.txt: line 1: '-inf' is not finite");
  CHECK(refusal("1 2 1e999") == "p.txt: line 1: '1e999' is beyond double precision");
  CHECK(refusal("1 2 +-3") == "p.txt: line 1: '+-3' is not a number");
  CHECK(refusal("1 2 +") == "p.txt: line 1: '+' is not a number");
  CHECK(refusal("1 2 0x10") == "p.txt: line 1: '0x10' is not a number");
  CHECK(refusal("") == "p.txt: no position in it");
  CHECK(refusal("# nothing\n\n") == "p.txt: no position in it");
  CHECK(refusal(std::string("1 2 3\0", 6)) == "p.txt: line 1: '3 ' is not a number");
  CHECK(refusal(std::string(99, 'x')) ==
        "p.txt: line 1: '" + std::string(40, 'x') + "' is not a number");
}

TEST_CASE("the path device gives its positions once and keeps the last force") {
  const std::string file = HAPGRID_BUILD_DIR "/path_test.txt";
  std::ofstream(file) << "1 2 3\n4 5 6\n";
  PathDevice device = PathDevice::open(file);
  CHECK(device.size() == 2);
  CHECK(device.force() == Vec3{0, 0, 0});
  DeviceInput x{.position = {9, 9, 9}};
  CHECK(device.read(x) == DeviceStatus::kOk);
  CHECK(x.position == Vec3{1, 2, 3});
  CHECK(device.send({1, 0, 2}) == DeviceStatus::kOk);
  CHECK(device.force() == Vec3{1, 0, 2});
  CHECK(device.read(x) == DeviceStatus::kOk);
  CHECK(device.read(x) == DeviceStatus::kEnd);
  CHECK(x.position == Vec3{4, 5, 6});
  CHECK(device.read(x) == DeviceStatus::kEnd);
  CHECK_THROWS_AS(PathDevice::open(HAPGRID_BUILD_DIR "/no such file"), std::system_error);
}

TEST_CASE("a path's read() and send() do not allocate") {
  PathDevice device(std::vector<Vec3>(1000, Vec3{1, 2, 3}));
  DeviceInput input;
  bool ok = true;
  const std::uint64_t before = testing::allocations_of_thread();
  for (int i = 0; i < 1000; ++i)
    ok = device.read(input) == DeviceStatus::kOk && device.send({1, 0, 0}) == DeviceStatus::kOk &&
         ok;
  ok = device.read(input) == DeviceStatus::kEnd && device.stop() == DeviceStatus::kOk && ok;
  CHECK(testing::allocations_of_thread() == before);
  CHECK(ok);
}
