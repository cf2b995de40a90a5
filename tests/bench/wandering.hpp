// The hand of a simulated device: it goes from point to point as people do, and rests now and then.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/grid/box.hpp"

namespace hapgrid {

struct WanderingOptions {
  std::uint64_t seed = 1;
  double seconds = 5;  ///< of a session
  double speed = 0.1;  ///< the fastest leg's mean speed, in the unit of the box a second
  double hold = 1.5;   ///< seconds of a rest
  double rate_hz = 1000;
};

/// The positions of session `session`, one for each tick. The seed and the session alone decide
/// them.
///
/// The hand begins at a random point of the box from `low` to `high`, each as likely as any other.
/// With a probability of one half it rests there for `hold`. Then it goes straight to another such
/// point, as hands do: s(t) = 10 t^3 - 15 t^4 + 6 t^5 of the way, with t from 0 to 1 (least jerk;
/// Flash and Hogan 1985). The leg's mean speed is drawn from a quarter of `speed` to `speed`. At
/// the end of the leg the hand may rest again, and so on.
void wander(const WanderingOptions& options, const Vec3& low, const Vec3& high,
            std::uint64_t session, std::vector<Vec3>& places);

}  // namespace hapgrid
