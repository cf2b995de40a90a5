#include "tests/bench/wandering.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/random.hpp"

namespace hapgrid {

void wander(const WanderingOptions& options, const Vec3& low, const Vec3& high,
            std::uint64_t session, std::vector<Vec3>& places) {
  SplitMix64 random(mix(options.seed) + session);
  const auto anywhere = [&] {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = low[a] + random.part() * (high[a] - low[a]);
    return x;
  };
  const auto ticks_of = [&](double seconds) {
    // In this order a NaN, which a box without end has for lengths, is the most, too.
    return static_cast<std::size_t>(std::min(0x1p40, std::ceil(seconds * options.rate_hz)));
  };
  const std::size_t ticks = std::max<std::size_t>(ticks_of(options.seconds), 1);
  Vec3 from = anywhere();
  places.assign(1, from);
  while (places.size() < ticks) {
    if (random.below(2) == 0)
      places.resize(std::min(places.size() + ticks_of(options.hold), ticks), from);
    const Vec3 to = anywhere();
    const Vec3 way{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const double length = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    const double speed = options.speed * (1 + 3 * random.part()) / 4;
    const std::size_t leg = ticks_of(length / speed);
    for (std::size_t i = 1; i <= leg && places.size() < ticks; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(leg);
      const double s = t * t * t * (10 - 15 * t + 6 * t * t);
      places.push_back({from[0] + s * way[0], from[1] + s * way[1], from[2] + s * way[2]});
    }
    from = to;
  }
}

}  // namespace hapgrid
