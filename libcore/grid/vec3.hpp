// What several folders compute with vectors.
#pragma once

#include <cmath>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// Whether all three components are finite: a NaN or infinity in one makes the vector useless.
inline bool finite(const Vec3& v) noexcept {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

inline double dot(const Vec3& a, const Vec3& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace hapgrid
