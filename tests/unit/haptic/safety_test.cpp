#include "libcore/haptic/safety.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "libcore/base/error.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using hapgrid::testing::uniform;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kEps = std::numeric_limits<double>::epsilon();

double magnitude(const Vec3& f) { return std::hypot(f[0], f[1], f[2]); }

/// Components of any size and sign, special values among them.
double hostile(std::mt19937_64& random) {
  const double specials[] = {0,
                             -0.0,
                             kMax,
                             -kMax,
                             std::numeric_limits<double>::min(),
                             std::numeric_limits<double>::denorm_min(),
                             1,
                             -3};
  if (random() % 4 == 0) return specials[random() % std::size(specials)];
  return std::ldexp(uniform(random, -1, 1), static_cast<int>(random() % 2000) - 1000);
}

}  // namespace

TEST_CASE("no finite force is above the limit, and none is turned") {
  std::mt19937_64 random(1);
  for (const double limit : {0.0, 1e-300, 0.5, 3.0, 1e6}) {
    SafetyCore safety({.max_force = limit});
    for (int i = 0; i < 50000; ++i) {
      const Vec3 raw{hostile(random), hostile(random), hostile(random)};
      const SafeForce safe = safety.apply(raw);
      REQUIRE_FALSE(safe.faulted);
      REQUIRE(magnitude(safe.force) <= limit);
      if (!safe.clamped) {
        REQUIRE(safe.force == raw);
        continue;
      }
      if (limit == 1e-300 || limit == 0) continue;  // small components vanish
      // Clamped means at the limit: 8 eps are taken off, and the roundings are fewer.
      REQUIRE(magnitude(safe.force) >= limit * (1 - 16 * kEps));
      // Parallel: equal ratios to the largest component, within the four roundings of a component
      // (and what is lost below the smallest normal number).
      int largest = 0;
      for (int a = 1; a < 3; ++a)
        if (std::abs(raw[a]) > std::abs(raw[largest])) largest = a;
      for (int a = 0; a < 3; ++a) {
        const double ratio = safe.force[a] / safe.force[largest];
        REQUIRE(std::abs(ratio - raw[a] / raw[largest]) <= 4 * kEps);
        REQUIRE(std::signbit(safe.force[a]) == std::signbit(raw[a]));
      }
    }
  }
}

TEST_CASE("a force within the limit passes unchanged") {
  SafetyCore safety({.max_force = 5});
  CHECK(safety.apply({3, 0, -3.9}).force == Vec3{3, 0, -3.9});
  CHECK_FALSE(safety.apply({0, 0, 0}).clamped);
  CHECK(safety.apply({0, 60, 80}).clamped);
}

TEST_CASE("after a force that is not finite the output is zero until reset") {
  std::mt19937_64 random(2);
  for (const double bad : {std::nan(""), kInf, -kInf})
    for (int a = 0; a < 3; ++a) {
      SafetyCore safety;
      CHECK(safety.apply({1, 0, 0}).force == Vec3{1, 0, 0});
      Vec3 f{1, 1, 1};
      f[a] = bad;
      CHECK(safety.apply(f).faulted);
      for (int i = 0; i < 100; ++i) {
        const SafeForce safe =
            safety.apply({hostile(random), hostile(random), i % 7 ? hostile(random) : bad});
        REQUIRE(safe.faulted);
        REQUIRE(safe.force == Vec3{0, 0, 0});
      }
      safety.reset();
      CHECK(safety.apply({1, 0, 0}).force == Vec3{1, 0, 0});
      safety.trip();
      CHECK(safety.apply({1, 0, 0}).force == Vec3{0, 0, 0});
    }
}

TEST_CASE("an impossible limit is refused") {
  for (const double limit : {-1.0, kInf, std::nan("")})
    CHECK_THROWS_AS(SafetyCore({.max_force = limit}), Error);
}
