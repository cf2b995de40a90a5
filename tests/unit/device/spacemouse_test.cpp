
#include "libcore/grid/box.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/device/place.hpp"
#include "tools/devices/spacemouse_reports.hpp"

using namespace hapgrid;
using hapgrid::testing::place;
using Bytes = std::vector<std::uint8_t>;

TEST_CASE("SpaceMouse: a push is a deflection in the box's axes") {
  hapgrid_device_state input{};
  // x 175 = 0x00af to the right, y -350 = 0xfea2 away from the user, z 70 = 0x0046 down.
  CHECK(decode_spacemouse(Bytes{1, 0xaf, 0, 0xa2, 0xfe, 0x46, 0}, input));
  CHECK(place(input) == Vec3{0.5, 1, -0.2});
  // All six axes in one report: the first three are the same. 500 and -500 are as far as it goes.
  CHECK(decode_spacemouse(Bytes{1, 0xf4, 1, 0x0c, 0xfe, 0, 0, 1, 0, 2, 0, 3, 0}, input));
  CHECK(place(input) == Vec3{1, 1, 0});
  CHECK(decode_spacemouse(Bytes{1, 0, 0x80, 0, 0x80, 0xff, 0x7f}, input));
  CHECK(place(input) == Vec3{-1, 1, -1});
  // Rest: 8 counts and below.
  CHECK(decode_spacemouse(Bytes{1, 8, 0, 0xf8, 0xff, 9, 0}, input));
  CHECK(place(input) == Vec3{0, 0, -9 / 350.0});
}

TEST_CASE("SpaceMouse: a button lets the force come back, the second takes the next level") {
  hapgrid_device_state input{};
  input.position[0] = 0.1;
  CHECK(decode_spacemouse(Bytes{3, 2, 0}, input));
  CHECK(input.flags == HAPGRID_DEVICE_NEXT);
  CHECK(decode_spacemouse(Bytes{3, 3, 0}, input));
  CHECK(input.flags == (HAPGRID_DEVICE_NEXT | HAPGRID_DEVICE_RESET));
  CHECK(decode_spacemouse(Bytes{3, 1, 0}, input));
  CHECK(input.flags == HAPGRID_DEVICE_RESET);
  CHECK(decode_spacemouse(Bytes{1, 0xaf, 0, 0, 0, 0, 0}, input));
  CHECK(input.flags == HAPGRID_DEVICE_RESET);  // still held
  CHECK(decode_spacemouse(Bytes{3, 0, 0, 0x80}, input));
  CHECK(input.flags == HAPGRID_DEVICE_RESET);
  CHECK(decode_spacemouse(Bytes{3, 0, 0}, input));
  CHECK(input.flags == 0);
  CHECK_FALSE(decode_spacemouse(Bytes{3}, input));
  CHECK(place(input) == Vec3{0.5, 0, 0});
}

TEST_CASE("SpaceMouse: what does not move the HIP") {
  hapgrid_device_state input{};
  input.position[0] = 0.1;
  CHECK_FALSE(decode_spacemouse(Bytes{2, 0, 0, 0xe2, 0xff, 0, 0}, input));  // rotations
  CHECK_FALSE(decode_spacemouse(Bytes{0x17, 90}, input));                   // the battery
  CHECK_FALSE(decode_spacemouse(Bytes{1, 1, 0, 1, 0, 1}, input));           // too short
  CHECK_FALSE(decode_spacemouse(Bytes{}, input));
  CHECK(place(input) == Vec3{0.1, 0, 0});
}
