#include "libcore/loop/safety.hpp"

#include "tests/unit/catch.hpp"
#include "tests/unit/follow/random_grid.hpp"
#include "tests/unit/loop/limits.hpp"
#include "tests/unit/refusal.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

constexpr double kMax = std::numeric_limits<double>::max();

// Of any size, which sums of squares are not.
double magnitude(const Vec3& f) { return std::hypot(f[0], f[1], f[2]); }

/// Any size and sign, special values among them; finite.
double hostile(std::mt19937_64& random) {
  const double specials[] = {0, -0.0, kMax, -kMax, 0x1p-1022, 0x1p-1074, 1, -3};
  if (random() % 4 == 0) return specials[random() % std::size(specials)];
  return std::ldexp(uniform(random, -1, 1), static_cast<int>(random() % 2000) - 1000);
}

/// A limit that a user could give.
double any_limit(std::mt19937_64& random, double typical) {
  const auto kind = random() % 5;
  return kind == 0 ? 0 : kind == 1 ? kInf : typical * std::exp(uniform(random, -5, 5));
}

/// A tick in which nothing is remarkable.
SafetyInput tick(const Vec3& force) { return {.force = force}; }

}  // namespace

TEST_CASE("no finite force is above the limit, and none is turned") {
  std::mt19937_64 random(1);
  for (const double limit : {0.0, 1e-300, 0.5, 3.0, 1e6}) {
    SafetyCore safety(only_clamp(limit));
    for (int i = 0; i < 20000; ++i) {
      const Vec3 raw{hostile(random), hostile(random), hostile(random)};
      const SafeForce safe = safety.apply(tick(raw));
      REQUIRE_FALSE(safety.faulted());
      REQUIRE(magnitude(safe.force) <= limit);
      safety.reset();  // the tick before must not matter here: its rounding would
      if (limit == 1e-300 || limit == 0) continue;  // small components vanish
      int largest = 0;
      for (int a = 1; a < 3; ++a)
        if (std::abs(raw[a]) > std::abs(raw[largest])) largest = a;
      if (std::abs(raw[largest]) < 1e-300) continue;
      // Clamped means at the limit: 1e-12 is taken off, and the roundings are fewer.
      if (safe.acted & kClamped) REQUIRE(magnitude(safe.force) >= limit * (1 - 2e-12));
      // Parallel: equal ratios to the largest component, within the roundings of a component (and
      // what is lost below the smallest normal number).
      for (int a = 0; a < 3; ++a) {
        const double ratio = safe.force[a] / safe.force[largest];
        REQUIRE(std::abs(ratio - raw[a] / raw[largest]) <= 8 * kEps * std::abs(ratio) + 1e-300);
      }
    }
  }
}

TEST_CASE("|F| and |dF| keep their limits whatever comes, and a fault is zero in its own tick") {
  std::mt19937_64 random(2);
  std::uint32_t seen = 0;
  for (int run = 0; run < 400; ++run) {
    SafetyLimits limits;
    limits.gain = std::exp(uniform(random, -3, 3));
    limits.max_force = 3 * std::exp(uniform(random, -3, 3));
    limits.slew = any_limit(random, 1);
    limits.ramp_ms = std::min(any_limit(random, 200), 1e6);
    limits.max_speed = any_limit(random, 1);
    limits.buzz_force = any_limit(random, 0.5);
    limits.buzz_rate = any_limit(random, 30);
    limits.fade_cells = any_limit(random, 1);
    limits.watchdog_ticks = any_limit(random, 10);
    limits.reserve = any_limit(random, 1);
    limits.acceleration = std::min(any_limit(random, 40), 1e6);
    limits.encoder = std::min(any_limit(random, 1e-4), 1e-2);
    limits.delay_ticks = static_cast<double>(random() % (kMaxTankDelay + 1));
    SafetyCore safety(limits);
    Vec3 before = kZero;
    Vec3 calm{uniform(random, -5, 5), uniform(random, -5, 5), uniform(random, -5, 5)};
    for (int i = 0; i < 400; ++i) {
      SafetyInput in = tick(calm);
      const unsigned kind = random() % 24;
      if (kind < 8) {  // a walk
        for (double& c : calm) c += uniform(random, -0.2, 0.2);
      } else if (kind < 12) {  // a reversal
        for (double& c : calm) c = -c;
      } else if (kind < 15) {  // a jump
        calm = {uniform(random, -50, 50), uniform(random, -50, 50), uniform(random, -50, 50)};
      } else if (kind == 15) {
        in.force = {hostile(random), hostile(random), hostile(random)};
      } else if (kind == 16 && random() % 8 == 0) {
        in.force[random() % 3] = random() % 2 ? kNaN : -kInf;
      } else if (kind == 17 && random() % 8 == 0) {
        in.unusable = true;
      }
      in.stalled = random() % 32 == 0;
      in.clutch = random() % 32 == 0;
      in.chosen = random() % 32 == 0;
      in.missed = random() % 16 == 0 ? random() % 30 : 0;  // a pause
      in.dt = 0.001 * static_cast<double>(1 + in.missed);
      if (random() % 8 == 0) in.slew_dt = uniform(random, 0, 2) * in.dt;
      in.speed = random() % 16 == 0 ? std::abs(hostile(random)) : uniform(random, 0, 1);
      in.outside_cells = random() % 8 == 0 ? uniform(random, 0, 3) : 0;
      if (random() % 16 != 0)
        in.place = {uniform(random, -1e-3, 1e-3), 0, i * 1e-4};
      else if (random() % 2 == 0)
        in.place = {hostile(random), random() % 2 ? kNaN : 0, 0};
      const bool number = finite(limits.gain * in.force);
      const bool latched = safety.faulted();
      const SafeForce safe = safety.apply(in);
      seen |= safe.acted;

      REQUIRE(magnitude(safe.force) <= limits.max_force);
      if (!number || in.unusable || latched) {
        REQUIRE(safety.faulted());
        REQUIRE(safe.force == kZero);
      }
      if (in.stalled) REQUIRE(safe.force == kZero);
      if (static_cast<double>(in.missed) >= limits.watchdog_ticks) REQUIRE(safe.force == kZero);
      if (safe.acted & kSafetyZero) {
        REQUIRE(safe.force == kZero);
      } else {
        // The last roundings of three components of at most the limit.
        REQUIRE(magnitude(safe.force - before) <=
                limits.slew * 1000 * std::min(in.dt, in.slew_dt) + 4 * kEps * limits.max_force);
      }
      before = safe.force;
      if (latched && random() % 4 == 0) {
        safety.reset();
        before = kZero;
      }
    }
  }
  // Everything that can act did, or the sequences are too tame.
  CHECK(seen == (1U << kSafetyActions) - 1);
}

TEST_CASE("what is not finite holds zero until reset, and then comes back by the ramp") {
  SafetyCore safety({.slew = kInf, .ramp_ms = 100});
  for (int i = 0; i < 200; ++i) safety.apply(tick({1, 0, 0}));
  CHECK(safety.apply(tick({1, kNaN, 0})).force == kZero);
  for (int i = 0; i < 1000; ++i) {
    const SafeForce safe = safety.apply(tick({1, 0, 0}));
    REQUIRE(safe.force == kZero);
    REQUIRE(safe.acted == kFault);
  }
  safety.reset();
  for (int i = 1; i <= 100; ++i)
    REQUIRE(safety.apply(tick({1, 0, 0})).force[0] == Approx(i / 100.0).margin(1e-12));
  CHECK(safety.apply(tick({1, 0, 0})).acted == 0);
}

TEST_CASE("a state that the hand chose gives its force by the ramp, and its energy") {
  SafetyCore safety({.slew = 0.5, .ramp_ms = 100, .reserve = 0});
  SafetyInput in = tick({1, 0, 0});
  in.place = {0, 0, 0};
  in.model_energy = 0.002;
  for (int i = 0; i < 200; ++i) safety.apply(in);
  CHECK(safety.granted() == Approx(0.002));
  in.force = {-3, 0, 0};
  in.model_energy = 0.005;
  in.chosen = true;
  Vec3 before{1, 0, 0};
  for (int i = 1; i <= 100; ++i, in.chosen = false) {
    const SafeForce safe = safety.apply(in);
    REQUIRE(magnitude(safe.force - before) < 0.5 + 1e-9);
    // Softly to zero, then by the ramp: 0.03 N in a tick.
    if (i > 3) REQUIRE(safe.force[0] == Approx(-0.03 * i).margin(1e-9));
    before = safe.force;
  }
  CHECK(before[0] == Approx(-3));
  CHECK(safety.tank_energy() == Approx(0.005));
}

TEST_CASE("the slew limit is a line to the wanted force, in its direction") {
  SafetyLimits limits = only_clamp(10);
  limits.slew = 0.5;
  SafetyCore safety(limits);
  for (int i = 1; i <= 10; ++i) {
    const SafeForce safe = safety.apply(tick({3, 4, 0}));
    REQUIRE(safe.force[0] == Approx(0.3 * i).epsilon(1e-9));
    REQUIRE(safe.force[1] == Approx(0.4 * i).epsilon(1e-9));
    REQUIRE((safe.acted & kSlewed) != 0);
  }
  CHECK(safety.apply(tick({3, 4, 0})).acted == 0);
  // A missed tick's time counts: 2 ms allow 1 N.
  SafetyInput late = tick(kZero);
  late.dt = 0.002;
  late.missed = 1;
  CHECK(magnitude(safety.apply(late).force) == Approx(4));
}

TEST_CASE("a stall, a pause, and a hand that is too fast give zero at once, then a ramp") {
  SafetyLimits limits = only_clamp(10);
  limits.ramp_ms = 10;
  limits.max_speed = 1;
  limits.watchdog_ticks = 5;
  SafetyCore safety(limits);
  for (int i = 0; i < 20; ++i) safety.apply(tick({1, 0, 0}));
  const auto ramps = [](SafetyCore& core) {
    for (int i = 1; i <= 10; ++i)
      REQUIRE(core.apply(tick({1, 0, 0})).force[0] == Approx(i / 10.0).margin(1e-12));
  };
  SafetyInput in = tick({1, 0, 0});
  SECTION("stall") {
    in.stalled = true;
    CHECK(safety.apply(in).force == kZero);
    ramps(safety);
  }
  SECTION("pause") {
    in.missed = 4;
    in.dt = 0.005;
    CHECK(safety.apply(in).force[0] == 1);
    in.missed = 5;
    in.dt = 0.006;
    CHECK(safety.apply(in).force == kZero);
    ramps(safety);
  }
  SECTION("speed") {
    in.speed = 1.2;
    // Smoothed over 10 ms: above 1 when 1 - exp(-t / 10 ms) = 1 / 1.2, at 18 ms (with steps of
    // dt / (10 ms + dt) a tick later).
    int ticks = 0;
    while (safety.apply(in).force != kZero && ticks < 100) ++ticks;
    CHECK((ticks >= 17 && ticks <= 20));
    in.speed = 0.9;  // slower, but not calm
    CHECK(safety.apply(in).acted == kTooFast);
    in.speed = 0;
    ticks = 0;
    while (safety.apply(in).acted & kTooFast && ticks < 100) ++ticks;
    CHECK(ticks < 10);  // below half the limit after some 7 ms
  }
}

TEST_CASE("the force fades outside the box, and the clutch takes it away softly") {
  SafetyLimits limits = only_clamp(10);
  limits.fade_cells = 2;
  SafetyCore fading(limits);
  for (const auto& [cells, part] :
       {std::pair{0.0, 1.0}, {0.5, 0.75}, {1.5, 0.25}, {2.0, 0.0}, {9.0, 0.0}, {kInf, 0.0}}) {
    SafetyInput in = tick({4, 0, 0});
    in.outside_cells = cells;
    CHECK(fading.apply(in).force[0] == Approx(4 * part).margin(1e-9));
  }
  limits.slew = 1;
  SafetyCore clutched(limits);
  for (int i = 0; i < 10; ++i) clutched.apply(tick({4, 0, 0}));
  SafetyInput in = tick({4, 0, 0});
  in.clutch = true;
  for (int i = 1; i <= 4; ++i) REQUIRE(clutched.apply(in).force[0] == Approx(4 - i).margin(1e-9));
}

TEST_CASE("a limit cycle is damped, then stopped; a hand's own tremor is neither") {
  SafetyLimits limits = only_clamp(10);
  limits.buzz_force = 0.5;
  limits.buzz_rate = 30;
  const auto play = [&](double hertz, double newtons) {
    SafetyCore safety(limits);
    std::uint32_t acted = 0;
    for (int i = 0; i < 2000; ++i) {
      const double t = i * 0.001;
      acted |= safety.apply(tick({newtons * std::sin(2 * M_PI * hertz * t), 0, 1})).acted;
    }
    return acted;
  };
  CHECK(play(8, 2) == 0);                                  // 16 swings a second: tremor
  CHECK((play(20, 2) & (kDamped | kBuzzing)) == kDamped);  // 40
  CHECK((play(50, 2) & kBuzzing) == kBuzzing);             // 100
  CHECK(play(50, 0.2) == 0);                               // felt by nobody: swings of 0.4 N
  // Contact and no contact in turns, which never changes the direction.
  SafetyCore wall(limits);
  std::uint32_t acted = 0;
  for (int i = 0; i < 1000; ++i) acted |= wall.apply(tick(i / 5 % 2 ? Vec3{0, 0, 2} : kZero)).acted;
  CHECK((acted & kBuzzing) != 0);
  // And it is over some time after the buzz is: 60 swings decay to 7.5 in 0.25 s * ln 8.
  int ticks = 0;
  while (wall.apply(tick(kZero)).acted & kBuzzing && ticks < 10000) ++ticks;
  CHECK((ticks > 300 && ticks < 1500));
}

TEST_CASE("limits that are none are refused") {
  const auto refusal = [](const SafetyLimits& limits) {
    return testing::refusal([&] { SafetyCore safety(limits); });
  };
  CHECK(refusal({}).empty());
  CHECK(refusal({.max_force = -1}) ==
        "safety: the force limit is -1, it must be finite and not be negative");
  CHECK_FALSE(refusal({.max_force = kNaN}).empty());
  CHECK_FALSE(refusal({.gain = kInf}).empty());
  CHECK_FALSE(refusal({.slew = -1}).empty());
  CHECK(refusal({.slew = kInf}).empty());
  CHECK_FALSE(refusal({.watchdog_ticks = kNaN}).empty());
  CHECK_FALSE(refusal({.acceleration = kInf}).empty());
  CHECK(refusal({.delay_ticks = 31}) == "safety: the delay is 31 ticks, the limit is 30");
}
