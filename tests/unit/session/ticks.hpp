// Sessions for tests.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "libcore/session/reader.hpp"
#include "libcore/session/session.hpp"

namespace hapgrid::testing {

inline SessionHeader small_header() {
  return {"some-model_2",
          "00ff",
          "m",
          {{-1.5, 0.1, 1e-300}, 0.1, {2, 3, 4}},
          1000,
          {"clutch", "stalled", "level_changed", "safety_clamped"},
          "{\"a\": \"\u00e9\n\"}"};
}

/// Anything that a record can be.
inline std::vector<TickRecord> random_ticks(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  constexpr double kMost = std::numeric_limits<double>::max();
  const double kSpecial[] = {0, -0.0, 5e-324, -1e-310, kMost, -kMost, INFINITY, -INFINITY, NAN};
  const auto vector = [&] {
    Vec3 v;
    for (double& x : v)
      x = random() % 3 == 0 ? kSpecial[random() % std::size(kSpecial)]
                            : static_cast<double>(random()) * 1e-18 - 9;
    return v;
  };
  std::vector<TickRecord> ticks(count);
  std::uint64_t number = random() % 100;
  for (TickRecord& tick : ticks) {
    tick.number = number;
    tick.hip = vector();
    tick.raw_force = vector();
    tick.force = random() % 2 == 0 ? tick.raw_force : vector();
    for (auto& level : tick.levels) level = static_cast<std::uint8_t>(random());
    tick.flags = static_cast<std::uint32_t>(random());
    tick.lateness_ns = static_cast<std::uint32_t>(random());
    tick.compute_ns = static_cast<std::uint32_t>(random() >> 44);
    number += random() % 4 == 0 ? random() >> 20 : 1;
  }
  return ticks;
}

/// To the last bit, NaN and the sign of zero among them.
inline bool same(const TickRecord& a, const TickRecord& b) {
  const auto same_bits = [](const Vec3& v, const Vec3& w) {
    using Bits = std::array<std::uint64_t, 3>;
    return std::bit_cast<Bits>(v) == std::bit_cast<Bits>(w);
  };
  return a.number == b.number && same_bits(a.hip, b.hip) && same_bits(a.raw_force, b.raw_force) &&
         same_bits(a.force, b.force) && a.levels == b.levels && a.flags == b.flags &&
         a.lateness_ns == b.lateness_ns && a.compute_ns == b.compute_ns;
}

inline bool same(const std::vector<TickRecord>& a, const std::vector<TickRecord>& b) {
  return std::ranges::equal(a, b, [](const auto& x, const auto& y) { return same(x, y); });
}

inline std::vector<TickRecord> rest_of(SessionReader& reader) {
  std::vector<TickRecord> ticks;
  for (std::vector<TickRecord> chunk; reader.next(chunk);)
    ticks.insert(ticks.end(), chunk.begin(), chunk.end());
  return ticks;
}

}  // namespace hapgrid::testing
