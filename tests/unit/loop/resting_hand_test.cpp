// What becomes of a contact that a hand holds: it keeps its force, and no more comes back than was
// stated.

#include "libcore/loop/energy_tank.hpp"
#include "tests/bench/simulated.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/loop/limits.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

TEST_CASE("a contact that a trembling hand holds keeps its force where its energy is known") {
  // 1,000 N/m, held at 2 N for a minute, and trembled out of and into.
  constexpr double kWall = 1000, kDt = 0.001;
  for (const double middle : {-0.002, -1e-4}) {
    SafetyCore safety(only_tank());
    std::uint32_t acted = 0;
    for (int i = 0; i < 60000; ++i) {
      const double x = middle + 3e-4 * std::sin(2 * M_PI * 10 * i * kDt);
      const SafeForce safe = safety.apply(on_spring(kWall, x, 0));
      if (i < 200) continue;  // at the start the hand's speed is not known
      acted |= safe.acted;
      // Late by a tick, against the motion.
      REQUIRE(safe.force[0] ==
              Approx(-kWall * std::min(x, 0.0)).margin(kWall * 3e-4 * 2 * M_PI * 10 * kDt));
    }
    CHECK((acted & kEnergy) == 0);
    CHECK(safety.tank_energy() < kWall / 2 * std::pow(middle - 3e-4, 2) + 5e-5);
  }
}

TEST_CASE("a contact that lacks energy is full within seconds, for what was stated") {
  constexpr double kWall = 1000, kDt = 0.001;
  SafetyCore safety(only_tank());
  double given = 0, worst = 0;
  Vec3 sent = kZero;
  double before = -0.001;
  for (int i = 0; i < 5000; ++i) {
    const double x = -0.001 + 3e-4 * std::sin(2 * M_PI * 10 * i * kDt);
    given += sent[0] * (x - before);
    worst = std::max(worst, given);
    before = x;
    // The hand did not put it in: no ramp grants it.
    const SafeForce safe = safety.apply(on_spring(kWall, x));
    sent = safe.force;
    if (i >= 2000) REQUIRE((safe.acted & kEnergy) == 0);
  }
  CHECK(worst <= kTankSlack + 5e-4 + 5 * kRefill);
}

/// What 0.5 N, which push it along, give a hand in 5 s on a circle of so many metres, at so many
/// radians a second. energy: J that the model claims to hold; account: whether it is also the
/// energy that forces are compared with.
double given_on_circle(double radius, double omega, double energy, bool account) {
  SafetyCore safety(only_tank());
  double given = 0;
  Vec3 before{radius, 0, 0}, sent = kZero;
  for (int i = 0; i < 5000; ++i) {
    const double turned = omega * i * 0.001;
    const Vec3 x{radius * std::cos(turned), radius * std::sin(turned), 0};
    given += dot(sent, x - before);
    before = x;
    const auto known = i == 0 ? std::nullopt : std::optional(energy);
    sent = safety
               .apply({.force = {-0.5 * std::sin(turned), 0.5 * std::cos(turned), 0},
                       .place = x,
                       .model_energy = known,
                       .account = account ? known : std::nullopt})
               .force;
  }
  return given;
}

TEST_CASE("a hand that circles gets nothing of what a model claims to hold") {
  // At 20 mm/s, which would give it 10 mW. In the first tenth of a second nobody knows that it does
  // not hold.
  CHECK(given_on_circle(0.005, 4, 1, false) <= kTankSlack + 5e-4 + 0.1 * kRefill);
}

TEST_CASE("a hand that holds gets no more from forces that have no energy than was stated") {
  // At 5 mm/s, which is a hold: 2.5 mW, of which refills alone would give 2 mW. A tick's work more,
  // since it is known when it is over.
  CHECK(given_on_circle(0.001, 5, 0.01, true) <=
        kTankSlack + 5e-4 + kMostRefill + 0.5 * 0.005 * 0.001);
}

TEST_CASE("in a contact the full force is there a second after the start and after a fault") {
  // A wall of 300 N/m, and a hand of as much whose point is 5 mm inside: 0.75 N. It waits there, or
  // comes there from outside while the ramp rises.
  constexpr double kWall = 300;
  const double outside = GENERATE(0.0, 0.007);
  SimulatedDevice device({}, [&](std::uint64_t, std::vector<Vec3>& targets) {
    for (int i = 0; i < 4000; ++i)
      targets.push_back({-0.005 + outside * std::max(0.0, 1 - i / 200.0), 0, 0});
  });
  SafetyCore safety;
  DeviceInput input;
  Vec3 before = kZero;
  for (int i = 0; i < 4000; ++i) {
    REQUIRE(device.read(input) == DeviceStatus::kOk);
    SafetyInput in = on_spring(kWall, input.position[0], 0);
    const bool silent = in.stalled = i >= 2000 && i < 2050;
    const SafeForce safe = safety.apply(in);
    if (i % 2000 >= 1050) {
      REQUIRE((safe.acted & kEnergy) == 0);
      REQUIRE(in.force[0] == Approx(0.75).epsilon(0.02));
    }
    // A ramp of 500 ms, and a hand of 0.1 m/s at most into 300 N/m.
    if (!silent) REQUIRE(length_of(safe.force - before) < 1.5 / 500 + 2 * 300 * 0.1e-3);
    before = safe.force;
    static_cast<void>(device.send(safe.force));
  }
}

TEST_CASE("a hand that the ramp pushes out of a contact has its full force when the ramp ends") {
  // A wall of 900 N/m, and a hand of 60 N/m whose point is 5 mm inside. It begins there, where the
  // wall holds 11 mJ, and is pushed out to where it holds 0.04 mJ: what late forces are charged on
  // this way is more than that.
  constexpr double kWall = 900, kHand = 60, kEncoder = 5.5e-5;
  SimulatedDevice device({.stiffness = kHand, .encoder = kEncoder},
                         [](std::uint64_t, std::vector<Vec3>& targets) {
                           targets.assign(2000, {-0.005, 0, 0});
                         });
  SafetyCore safety;
  DeviceInput input;
  for (int i = 0; i < 2000; ++i) {
    REQUIRE(device.read(input) == DeviceStatus::kOk);
    const SafetyInput in = on_spring(kWall, input.position[0], 0);
    const SafeForce safe = safety.apply(in);
    if (i >= 550) REQUIRE((safe.acted & kEnergy) == 0);
    if (i >= 1000)  // The hand has come to rest, to a step of its encoder.
      REQUIRE(in.force[0] ==
              Approx(kHand * kWall / (kHand + kWall) * 0.005).margin(kWall * kEncoder));
    static_cast<void>(device.send(safe.force));
  }
}
