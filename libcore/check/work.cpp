#include "libcore/check/work.hpp"

#include <cmath>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

double Work::length(const Link& link) const {
  const Vec3& d = grid_.neighbourhood().shift(link.q);
  return std::sqrt(dot(d, d));
}

}  // namespace hapgrid
