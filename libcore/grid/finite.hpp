// Whether all components of a vector are finite: one that is not makes the vector useless.
#pragma once

#include <cmath>

#include "libcore/grid/box.hpp"

namespace hapgrid {

inline bool finite(const Vec3& v) noexcept {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

}  // namespace hapgrid
