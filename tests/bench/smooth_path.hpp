// The way of a hand for benchmarks.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "libcore/grid/box.hpp"

namespace hapgrid::bench {

/// A Lissajous figure that stays inside [-1, 1]^3, with steps of about the length `step`.
inline std::vector<Vec3> smooth_path(double step, std::size_t count) {
  std::vector<Vec3> path(count);
  double t = 0;
  for (Vec3& x : path) {
    x = {0.97 * std::sin(t), 0.97 * std::sin(1.618 * t + 0.5), 0.97 * std::sin(2.414 * t + 1)};
    const double speed = std::hypot(0.97 * std::cos(t), 1.57 * std::cos(1.618 * t + 0.5),
                                    2.34 * std::cos(2.414 * t + 1));
    t += step / std::max(speed, 0.3);
  }
  return path;
}

}  // namespace hapgrid::bench
