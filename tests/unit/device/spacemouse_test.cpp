#include "libcore/device/spacemouse.hpp"

#include <catch2/catch.hpp>
#include <vector>

using namespace hapgrid;
using Bytes = std::vector<std::uint8_t>;

TEST_CASE("SpaceMouse: a push is a rate in the box's axes") {
  SpaceMouseProtocol mouse("SpaceNavigator");
  DeviceInput input;
  input.position = {1, 2, 3};
  // x 175 = 0x00af to the right, y -350 = 0xfea2 away from the user, z 70 = 0x0046 down.
  CHECK(mouse.decode(Bytes{1, 0xaf, 0, 0xa2, 0xfe, 0x46, 0}, input));
  CHECK(input.rate == Vec3{0.5, 1, -0.2});
  CHECK(input.position == Vec3{1, 2, 3});
  CHECK_FALSE(input.clutch);
  // All six axes in one report: the first three are the same. 500 and -500 are as far as it goes.
  CHECK(mouse.decode(Bytes{1, 0xf4, 1, 0x0c, 0xfe, 0, 0, 1, 0, 2, 0, 3, 0}, input));
  CHECK(input.rate == Vec3{1, 1, 0});
  CHECK(mouse.decode(Bytes{1, 0, 0x80, 0, 0x80, 0xff, 0x7f}, input));
  CHECK(input.rate == Vec3{-1, 1, -1});
  // Rest: 8 counts and below.
  CHECK(mouse.decode(Bytes{1, 8, 0, 0xf8, 0xff, 9, 0}, input));
  CHECK(input.rate == Vec3{0, 0, -9 / 350.0});
}

TEST_CASE("SpaceMouse: a button lets the force come back, and leaves the rate") {
  SpaceMouseProtocol mouse("SpaceNavigator");
  DeviceInput input;
  input.rate = {0.1, 0.2, 0.3};
  CHECK(mouse.decode(Bytes{3, 2, 0}, input));
  CHECK(input.reset);
  CHECK(mouse.decode(Bytes{1, 0xaf, 0, 0, 0, 0, 0}, input));
  CHECK(input.reset);  // still held
  CHECK(mouse.decode(Bytes{3, 0, 0, 0x80}, input));
  CHECK(input.reset);
  CHECK(mouse.decode(Bytes{3, 0, 0}, input));
  CHECK_FALSE(input.reset);
  CHECK_FALSE(mouse.decode(Bytes{3}, input));
  CHECK(input.rate == Vec3{0.5, 0, 0});
}

TEST_CASE("SpaceMouse: what does not move the HIP") {
  SpaceMouseProtocol mouse("SpaceNavigator");
  DeviceInput input;
  input.rate = {0.1, 0.2, 0.3};
  CHECK_FALSE(mouse.decode(Bytes{2, 0, 0, 0xe2, 0xff, 0, 0}, input));  // rotations
  CHECK_FALSE(mouse.decode(Bytes{0x17, 90}, input));                   // the battery
  CHECK_FALSE(mouse.decode(Bytes{1, 1, 0, 1, 0, 1}, input));           // too short
  CHECK_FALSE(mouse.decode(Bytes{}, input));
  CHECK(input.rate == Vec3{0.1, 0.2, 0.3});
  CHECK(mouse.timing().stall == 0);
  CHECK(mouse.stop().empty());
  std::vector<HidReport> reports{{1}};
  mouse.encode({1, 1, 1}, reports);
  CHECK(reports.empty());
}
