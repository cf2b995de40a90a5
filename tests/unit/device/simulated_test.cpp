#include "tests/bench/simulated.hpp"

#include "tests/unit/catch.hpp"

using namespace hapgrid;

namespace {

constexpr Vec3 kOrigin{0, 0, 0};

/// A device in one session of `ticks`, whose hand's point follows `target`.
SimulatedDevice device(const SimulatedOptions& options, std::size_t ticks,
                       const std::function<Vec3(double)>& target) {
  return SimulatedDevice(options, [=](std::uint64_t, std::vector<Vec3>& targets) {
    targets.clear();
    for (std::size_t i = 0; i < ticks; ++i)
      targets.push_back(target(static_cast<double>(i) / options.rate_hz));
  });
}

}  // namespace

TEST_CASE("a handle on a spring and a damper swings as the closed form says") {
  // A constant force F from rest: x = F/k (1 - e^(-d t) (cos w t + d/w sin w t)), at any rate.
  for (const double rate : {50.0, 1000.0, 20000.0}) {
    const SimulatedOptions options{.hand_damping = 2, .encoder = 0, .rate_hz = rate};
    const double d = 2 / (2 * 0.1);
    const double w = std::sqrt(300 / 0.1 - d * d);
    SimulatedDevice swing = device(options, 1000, [](double) { return kOrigin; });
    DeviceInput input;
    for (int n = 0; swing.read(input) == DeviceStatus::kOk; ++n) {
      CHECK(input.begins == (n == 0));
      const double t = n / rate;
      const double x =
          2.0 / 300 * (1 - std::exp(-d * t) * (std::cos(w * t) + d / w * std::sin(w * t)));
      // The exact solution: a thousand products of numbers below 1 round by less than 1e-12.
      CHECK(std::abs(input.position[1] - x) < 1e-12);
      CHECK(std::abs(swing.work() - 2.0 * x) < 1e-12);
      REQUIRE(swing.send({0, 2, 0}) == DeviceStatus::kOk);
    }
  }
}

TEST_CASE("a force is in effect after the delay, and positions are rounded to the encoder's step") {
  SimulatedDevice late = device({.encoder = 1e-4, .delay = 3}, 100, [](double) {
    return Vec3{1.26e-4, 0, -1.26e-4};
  });
  DeviceInput input;
  for (int n = 0; late.read(input) == DeviceStatus::kOk; ++n) {
    // The force of tick 0 is in effect from tick 3 to tick 4.
    CHECK((late.position()[0] == 1.26e-4) == (n <= 3));
    if (n <= 3) CHECK(input.position == Vec3{1e-4, 0, -1e-4});
    REQUIRE(late.send({5, 0, 0}) == DeviceStatus::kOk);
  }
  CHECK(late.info().low == Vec3{-0.05, -0.05, -0.05});
  CHECK(late.info().unit == DeviceInfo::Unit::kMetres);
}

TEST_CASE("a wandering hand stays in its box, keeps its speed, and rests") {
  const Vec3 low{-1, 0, 2}, high{1, 0, 2.5};
  const WanderingOptions options{.seed = 3, .seconds = 4, .speed = 0.5, .hold = 1.25};
  int rests = 0, shorter = 0;
  double fastest = 0;
  std::vector<Vec3> places;
  for (std::uint64_t session = 0; session < 200; ++session) {
    wander(options, low, high, session, places);
    REQUIRE(places.size() == 4000);
    int still = 1;
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (int a = 0; a < 3; ++a) CHECK_FALSE((places[i][a] < low[a] || places[i][a] > high[a]));
      if (i == 0) continue;
      const Vec3 &x = places[i], &y = places[i - 1];
      fastest = std::max(fastest, length_of(x - y) * 1000);
      rests += x != y && still >= 1250;
      shorter += x != y && still > 10 && still < 1250;
      still = x == y ? still + 1 : 1;
    }
  }
  CHECK(shorter == 0);
  CHECK(rests > 100);
  // Least jerk is 15/8 times the mean speed at its fastest; a leg of whole ticks is no faster.
  CHECK(fastest <= 0.5 * 15 / 8);
  CHECK(fastest > 0.45 * 15 / 8);
}
