#include "libcore/loop/mapping.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/follow/random_grid.hpp"

using namespace hapgrid;
using hapgrid::testing::uniform;

namespace {

const Box kBox{{-2, 0, 10}, 0.5, {9, 5, 3}};  // 4 x 2 x 1, its middle (0, 1, 10.5)

DeviceInfo held(const Vec3& low, const Vec3& high) {
  return {.name = "held", .unit = DeviceInfo::Unit::kMetres, .low = low, .high = high};
}

Vec3 at(Mapping& mapping, const Vec3& hand) { return mapping.hip({.position = hand}, 0.001); }

}  // namespace

TEST_CASE("the device's reach fills the box, its middle is the box's") {
  Mapping mapping({}, held({-0.1, 0, 0}, {0.1, 0.2, 0.2}), kBox);
  CHECK(mapping.scale() == Approx(20));  // 4 units in 0.2 m
  const Vec3 middle = at(mapping, {0, 0.1, 0.1});
  CHECK(middle[0] == Approx(0).margin(1e-12));
  CHECK(middle[1] == Approx(1));
  CHECK(middle[2] == Approx(10.5));
  CHECK(at(mapping, {-0.1, 0.1, 0.1})[0] == Approx(-2));
  CHECK(at(mapping, {0.1, 0.1, 0.1})[0] == Approx(2));
  // Two axes only: the third does not count.
  CHECK(Mapping({}, held({-1, -1, 0}, {1, 1, 0}), kBox).scale() == Approx(2));
}

TEST_CASE("axes, scale and offset; a force does the work that the hand does") {
  MappingOptions options{
      .scale = 7, .axes = {Vec3{0, 0, -1}, {1, 0, 0}, {0, 1, 0}}, .offset = {1, 2, 3}};
  Mapping mapping(options, held({-1, -1, -1}, {1, 1, 1}), kBox);
  CHECK(at(mapping, {0, 0, 0}) == Vec3{1, 3, 13.5});
  CHECK(at(mapping, {1, 0, 0}) == Vec3{1, 10, 13.5});
  CHECK(at(mapping, {0, 0, 1}) == Vec3{-6, 3, 13.5});
  // Whatever the axes: F . dx at the hand is F . dx in the box, but for the scale.
  std::mt19937_64 random(1);
  for (int i = 0; i < 100; ++i) {
    const auto any = [&] {
      return Vec3{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
    };
    const Vec3 a = any(), b = any(), force = any();
    const double in_box = dot(force, at(mapping, b) - at(mapping, a));
    REQUIRE(7 * dot(mapping.to_device(force), b - a) == Approx(in_box).margin(1e-12));
  }
}

TEST_CASE(
    "a device that pushes the wrong way along its y gets that force turned around, and nothing "
    "else") {
  MappingOptions options{.scale = 7, .axes = {Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}};
  options.push = {1, -1, 1};
  const Mapping mapping(options, held({-1, -1, -1}, {1, 1, 1}), kBox);
  CHECK(mapping.to_device({1, 2, 4}) == Vec3{2, -4, -1});
  CHECK(mapping.place(mapping.handle({1, 2, 3})) == Vec3{1, 2, 3});
}

TEST_CASE("the clutch moves the handle without the HIP, as often as one likes") {
  Mapping mapping({.scale = 10}, held({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}), kBox);
  Vec3 hip = at(mapping, {0, 0, 0});
  for (int stroke = 0; stroke < 3; ++stroke) {
    for (int i = 0; i <= 10; ++i) hip = at(mapping, {0.01 * i, 0, 0});
    for (int i = 10; i >= 0; --i)
      CHECK(mapping.hip({.position = {0.01 * i, 0, 0}, .clutch = true}, 0.001) == hip);
  }
  CHECK(hip[0] == Approx(3));  // three strokes of 0.1 m, 10 a metre
}

TEST_CASE("where the handle is for a HIP") {
  const Mapping there(
      {.scale = 8, .axes = {Vec3{0, -1, 0}, {0, 0, 1}, {1, 0, 0}}, .offset = {1, 0, 0}},
      held({-1, 0, 0}, {1, 2, 3}), kBox);
  Mapping back = there;
  for (const Vec3& x : {Vec3{0, 0, 0}, Vec3{0.5, -0.25, 11}, Vec3{-3, 7, 10}}) {
    CHECK(back.hip({.position = there.handle(x)}, 1) == x);  // exact: all numbers are dyadic
    CHECK(there.place(there.handle(x)) == x);
  }
  CHECK(!finite(there.place(kNowhere)));
  CHECK(Mapping({}, {.name = "path"}, kBox).place({5, 6, 7}) == Vec3{5, 6, 7});
}

TEST_CASE("a HIP that is steered moves with its speed and stays in the box") {
  const DeviceInfo steered{.name = "steered", .unit = DeviceInfo::Unit::kRate};
  Mapping mapping({.speed = 2}, steered, kBox);
  const auto steer = [&](const Vec3& rate, double seconds) {
    Vec3 hip{};
    for (int i = 0; i < static_cast<int>(seconds * 1000); ++i)
      hip = mapping.hip({.rate = rate}, 0.001);
    return hip;
  };
  CHECK(steer({0.5, 0, 0}, 1)[0] == Approx(1));
  CHECK(steer({0, 0, 0}, 1)[0] == Approx(1));
  CHECK(steer({1, 0, 0}, 9)[0] == 2);
  CHECK(steer({-1, 0, 0}, 1)[0] == Approx(0).margin(1e-9));  // it did not run on at the wall
  Mapping by_default({}, steered, kBox);
  Vec3 hip{};
  for (int i = 0; i < 1000; ++i) hip = by_default.hip({.rate = {1, 0, 0}}, 0.001);
  CHECK(hip[0] == Approx(1));  // the longest side, 4, in four seconds
}

TEST_CASE("how far outside, in spacings") {
  const Mapping mapping({}, {.name = "path"}, kBox);
  CHECK(mapping.outside_cells({0, 1, 10.5}) == 0);
  CHECK(mapping.outside_cells({-2, 2, 11}) == 0);
  CHECK(mapping.outside_cells({2.25, 1, 10.5}) == 0.5);
  CHECK(mapping.outside_cells({-3.5, 4, 11}) == Approx(5));  // 3 and 4
}
