// The HIP on the spring of a hand without a force has closed forms behind a wall and after a snap.
// A grid in a page is in tests/cli/view/grid-page.sh.
#include "tools/page/coupled_hip.hpp"

#include "libcore/grid/vec3.hpp"
#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

// The longest side is 2, so that the spring has 3 N / (2 / 3) = 4.5 N a unit.
const Box kBox{{-1, -0.5, -0.5}, 0.5, {5, 3, 3}};
const Vec3 kStart{0, 0, 0};
constexpr double kSpring = 4.5;
constexpr double kTick = 0.001;

/// A wall at x = 0: its force on the HIP, in newtons.
Vec3 wall(double stiffness, const Vec3& x) { return {-stiffness * std::max(0.0, x[0]), 0, 0}; }

/// The HIP on the way to where it rests in the wall: its x at each tick of a second.
std::vector<double> pressed(CoupledHip& hip, double stiffness, double hand) {
  std::vector<double> xs;
  Vec3 x = hip.next({hand, 0, 0}, {0, 0, 0}, 0);
  for (int i = 0; i < 1000; ++i) {
    x = hip.next({hand, 0, 0}, wall(stiffness, x), kTick);
    xs.push_back(x[0]);
  }
  return xs;
}

}  // namespace

TEST_CASE("behind a wall the HIP makes k / (k + K) of the hand's motion, and does not swing") {
  CHECK(CoupledHip(kBox, kStart).stiffness() == Approx(kSpring));
  // Up to K = b / dt = 30 k.
  for (const double stiffness : {1.0, 6.0, 60.0, 30 * kSpring}) {
    CAPTURE(stiffness);
    const double shown = kSpring / (kSpring + stiffness);
    CoupledHip hip(kBox, kStart);
    double before = 0;
    for (const double hand : {0.1, 0.2, 0.4}) {
      const auto xs = pressed(hip, stiffness, hand);
      CHECK(xs.back() == Approx(shown * hand));
      for (const double x : xs) {
        REQUIRE(x >= before - 1e-12);
        before = x;
      }
    }
  }
}

TEST_CASE("beyond twice that stiffness it swings, but stays in the box and below its speed") {
  CoupledHip hip(kBox, kStart);
  const auto xs = pressed(hip, 62 * kSpring, 0.4);
  CHECK(std::abs(xs[999] - xs[998]) > 1e-3);
  for (std::size_t i = 1; i < xs.size(); ++i)
    REQUIRE(std::abs(xs[i] - xs[i - 1]) <= 2 * kHandSpeed * kTick * (1 + 1e-9));
}

TEST_CASE("at a snap the HIP goes to the hand, with its time constant, and not beyond") {
  CoupledHip hip(kBox, kStart);
  const double lag = 0.4 - pressed(hip, 60, 0.4).back();
  CHECK(lag == Approx(0.4 * 60 / 64.5));
  // The speed is a limit at first: 0.37 / 31 is above 8e-3 a tick.
  double left = lag;
  const double part = kTick / (kHandSeconds + kTick);
  for (int i = 1; i <= 300; ++i) {
    left -= std::min(part * left, 2 * kHandSpeed * kTick);
    REQUIRE(0.4 - hip.next({0.4, 0, 0}, {0, 0, 0}, kTick)[0] == Approx(left).margin(1e-12));
  }
  CHECK(left < 1e-3 * lag);
}

TEST_CASE("a leap of the hand, a hiccup and absurd numbers move the HIP no faster") {
  CoupledHip hip(kBox, kStart);
  Vec3 last = hip.next({0, 0, 0}, {0, 0, 0}, 0);
  const auto step = [&](const Vec3& hand, const Vec3& force, double dt) {
    const Vec3 x = hip.next(hand, force, dt);
    REQUIRE(length_of(x - last) <= 2 * kHandSpeed * std::min(dt, 0.004) * (1 + 1e-9));
    for (int a = 0; a < 3; ++a) REQUIRE((x[a] >= kBox.origin[a] && x[a] <= kBox.high()[a]));
    last = x;
  };
  step({1, 0, 0}, {0, 0, 0}, kTick);
  step({1, 0, 0}, {0, 0, 0}, 10);
  constexpr double kMost = std::numeric_limits<double>::max();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 10000; ++i) {
    const double size = std::pow(10.0, 300 * unit(random));
    step({size * unit(random), kMost * unit(random), unit(random)},
         {3 * unit(random), 3 * unit(random), 3 * unit(random)}, 0.01 * (1 + unit(random)));
  }
}

TEST_CASE("a hand goes no farther out than the HIP can lag behind it") {
  const auto [low, high] = hand_range({.origin = {0, 0, 0}, .spacing = 0.5, .counts = {5, 3, 3}});
  CHECK(low[1] == Approx(-2 * kHandReach));
  CHECK(high[0] == Approx(2 + 2 * kHandReach));
}
