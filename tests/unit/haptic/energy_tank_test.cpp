// The third promise of the safety core: the energy that a hand gets back, counted outside of it.
#include "libcore/haptic/energy_tank.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "libcore/grid/vec3.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/haptic/limits.hpp"
#include "tests/unit/haptic/numbers.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

/// A hand whose acceleration is bounded, and the work of the force that is in effect, in joules.
struct Hand {
  double encoder = 0;
  std::size_t delay = 0;  // in ticks
  double damping = 0;     // N s/m, which takes energy from the hand
  Vec3 x{0, 0, 0}, v{0, 0, 0};
  std::vector<Vec3> sent = std::vector<Vec3>(40, kZero);
  double given = 0;    // along the true positions
  double counted = 0;  // along those that the encoder shows, less the damper's
  double returned = 0, counted_returned = 0;  // the most of both at any time

  Vec3 shown() const {
    if (encoder == 0) return x;
    Vec3 rounded;
    for (int a = 0; a < 3; ++a) rounded[a] = std::round(x[a] / encoder) * encoder;
    return rounded;
  }
  const Vec3& in_effect() const { return sent[sent.size() - 1 - delay]; }
  /// @param a acceleration, constant in the tick
  void advance(const Vec3& a, double dt) {
    const Vec3 before = x, shown_before = shown();
    x = x + dt * (v + dt / 2 * a);
    v = v + dt * a;
    given += dot(in_effect(), x - before);
    const Vec3 way = shown() - shown_before;
    counted += dot(in_effect(), way) - damping * dot(way, way) / dt;
    returned = std::max(returned, given);
    counted_returned = std::max(counted_returned, counted);
  }
};

/// A vector of the length.
Vec3 any_direction(std::mt19937_64& random, double length) {
  for (;;) {
    const Vec3 d{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
    if (length_of(d) > 0.1 && length_of(d) < 1) return length / length_of(d) * d;
  }
}

/// What a source of forces that wants to give energy does, in three ways, and how the hand helps.
Vec3 hostile_force(std::mt19937_64& random, int kind, const Hand& hand, Vec3& held) {
  if (random() % 20 == 0) held = any_direction(random, uniform(random, 0, 5));
  if (kind == 0) return held;
  const double speed = length_of(hand.v);
  const double sign = kind == 1 ? 1 : (random() % 100 < 60 ? -1 : 1);  // 2: first loads, then pays
  if (speed == 0) return held;
  return sign * 5 / speed * hand.v;
}

Vec3 hostile_acceleration(std::mt19937_64& random, const Hand& hand, double most) {
  const double speed = length_of(hand.v);
  const Vec3& force = hand.in_effect();
  const double size = length_of(force);
  if (speed > 0.5 && random() % 2)  // brake, so that it begins anew
    return -most / speed * hand.v;
  if (size > 0 && random() % 4)  // run along with the force
    return most / size * force;
  return any_direction(random, most);
}

}  // namespace

TEST_CASE("what it costs to let go, against its sum") {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const TankTerms terms{.acceleration = random() % 4 ? uniform(random, 0, 100) : 0,
                          .slew = std::exp(uniform(random, 3, 8)),
                          .period = std::exp(uniform(random, -9, -6))};
    const double force = std::exp(uniform(random, -4, 2));
    const double speed = uniform(random, -1, 1);
    const double step = terms.slew * terms.period;
    double sum = 0;
    for (int j = 0; force - j * step > 0; ++j)
      sum += terms.period * (force - j * step) *
             std::max(0.0, speed + terms.acceleration * (j + 0.5) * terms.period);
    // Terms of up to (force / step)^3 cancel, a few times 1e9 of which the last bit is 1e-7.
    REQUIRE(letgo(force, speed, terms) == Approx(sum).epsilon(1e-9).margin(1e-12));
  }
  CHECK(letgo(2, 0.5, {.slew = kInf}) == Approx(2 * 0.001 * (0.5 + 0.02)));
  CHECK(letgo(0, kInf, {}) == 0);
  CHECK(letgo(1, 1, {.slew = 0}) == kInf);
}

TEST_CASE("no sequence of forces gives a hand more than was stored and the bound") {
  std::mt19937_64 random(2);
  double worst = 0;
  std::uint32_t acted = 0;
  for (int run = 0; run < 150; ++run) {
    const double dt = run % 2 ? 0.001 : 0.0002;
    const int kind = run % 3;
    const bool unknown = run % 5 == 4;  // one more tick of delay than the core knows of
    SafetyLimits limits = only_tank(run % 11 > 2 ? 0 : run % 11 * 0.5);
    limits.encoder = run % 4 ? 0 : 2e-4;
    limits.delay_ticks = static_cast<double>(run / 4 % 3);
    SafetyCore safety(limits);
    const double stored = run % 7 ? 0 : 2e-3;
    Hand hand{.encoder = limits.encoder,
              .delay = static_cast<std::size_t>(limits.delay_ticks) + unknown,
              .damping = limits.damping};
    hand.v = any_direction(random, uniform(random, 0.01, 1));
    Vec3 held = any_direction(random, 3);
    Vec3 before = kZero;
    double largest = 0, largest_change = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 wanted = hostile_force(random, kind, hand, held);
      const SafeForce safe =
          safety.apply({.force = wanted, .dt = dt, .place = hand.shown(), .stored = stored});
      acted |= safe.acted;
      largest = std::max(largest, length_of(safe.force));
      largest_change = std::max(largest_change, length_of(safe.force - before));
      before = safe.force;
      hand.sent.erase(hand.sent.begin());
      hand.sent.push_back(safe.force);
      hand.advance(hostile_acceleration(random, hand, limits.acceleration), dt);
    }
    REQUIRE(largest <= 3);
    REQUIRE(largest_change <= 1000 * dt + 1e-15);
    // Rounding: 2,000 sums of work below 1 J.
    const double bound = stored + 0.51e-3 + 1e-12;
    worst = std::max(worst, hand.counted_returned - stored);
    REQUIRE(hand.counted_returned <= bound);
    if (limits.encoder == 0 && limits.damping == 0) REQUIRE(hand.returned == hand.counted_returned);
  }
  CHECK((acted & kEnergy) != 0);
  CHECK(worst > 0.2e-3);  // the bound is not met by giving nothing
}

TEST_CASE("a fault does not fill the tank again") {
  const SafetyLimits limits = only_tank();
  SafetyCore safety(limits);
  Hand hand;
  hand.v = {0.05, 0, 0};
  for (int i = 0; i < 20000; ++i) {
    const bool broken = i % 50 == 49;
    if (safety.faulted()) safety.reset();
    // It pushes the hand along, and breaks again and again.
    const SafeForce safe = safety.apply({.force = {broken ? kNaN : 3, 0, 0}, .place = hand.x});
    hand.sent.push_back(safe.force);
    hand.advance(kZero, 0.001);
  }
  CHECK(hand.returned > 0);
  CHECK(hand.returned <= 0.51e-3 + 1e-12);
  CHECK(safety.stored() <= -hand.given + 1e-12);
}

TEST_CASE("missed ticks are charged when they are over, and gain nothing") {
  const SafetyLimits limits = only_tank();
  SafetyCore safety(limits);
  double x = 0;
  const auto tick = [&](double force, double moved, std::uint64_t missed) {
    x += moved;
    return safety
        .apply({.force = {force, 0, 0},
                .dt = 0.001 * static_cast<double>(missed + 1),
                .missed = missed,
                .place = Vec3{x, 0, 0},
                .stored = 1})
        .force[0];
  };
  tick(0, 0, 0);
  for (int i = 0; i < 4; ++i) tick(2, 0, 0);
  REQUIRE(tick(2, 0, 0) == 2);
  REQUIRE(safety.stored() == 1);
  tick(2, 0.003, 5);  // 2 N over 3 mm
  CHECK(safety.stored() == Approx(1 - 6e-3));
  tick(2, -0.003, 5);  // nobody knows whether the device still pushed against it
  CHECK(safety.stored() == Approx(1 - 6e-3));
  tick(2, -0.003, 0);
  CHECK(safety.stored() == Approx(1));
}

TEST_CASE("what was not seen gains nothing, and the clutch is paid for") {
  SafetyCore safety(only_tank());
  const auto tick = [&](double x, bool stalled, bool clutch) {
    return safety
        .apply({.force = {2, 0, 0},
                .place = Vec3{x, 0, 0},
                .stored = 1,
                .stalled = stalled,
                .clutch = clutch})
        .force[0];
  };
  for (int i = 0; i < 9; ++i) tick(0, false, false);
  SECTION("a silent device") {
    CHECK(tick(0, true, false) == 0);
    CHECK(tick(-0.1, false, false) == 0);  // and the speed is not known yet
    CHECK(safety.stored() == 1);
  }
  SECTION("the clutch") {
    for (const double force : {1.0, 0.0, 0.0})
      CHECK(tick(0, false, true) == Approx(force).margin(1e-9));
    // 2 N, then 1 N, for a hand that was at rest 1 ms ago on average, with an encoder's step of
    // error: 40 m/s^2 over 1 ms and the half of each tick.
    // The 2 N may come a tick later, after those before.
    const double speed = 0.04 + 5.5e-5 / 0.002;
    CHECK(safety.stored() == Approx(1 - (2e-3 * (speed + 0.02) + 2e-3 * (speed + 0.06) +
                                         1e-3 * (speed + 0.1) + 4 * 5.5e-5)));
  }
}

TEST_CASE("without a scale, and with an infinite reserve, no energy is counted") {
  for (const bool known : {true, false}) {
    SafetyLimits limits = only_tank();
    if (known) limits.reserve = kInf;
    SafetyCore safety(limits);
    double x = 0;
    for (int i = 0; i < 200; ++i) {
      const SafeForce safe = safety.apply(
          {.force = {0.9, 0, 0}, .place = known ? std::optional(Vec3{x, 0, 0}) : std::nullopt});
      REQUIRE(safe.acted == 0);
      REQUIRE(safe.force == Vec3{0.9, 0, 0});
      x += 1e-3;  // along with the force, for ever
    }
  }
}

TEST_CASE("a wall that takes more than it gives back is not touched") {
  SafetyCore safety(only_tank());
  for (int i = 0; i < 5000; ++i) {
    // In and out, at 0.1 m/s at most; 200 N/m, and 2 N s/m.
    const double t = i * 0.001, v = 0.1 * std::cos(10 * t), x = 0.01 * std::sin(10 * t);
    const Vec3 wall{x < 0 ? std::max(0.0, -200 * x - 2 * v) : 0, 0, 0};
    const SafeForce safe = safety.apply({.force = wall, .place = Vec3{x, 0, 0}});
    REQUIRE(safe.acted == 0);
    REQUIRE(safe.force == wall);
  }
}
