#include "libcore/grid/box.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// The directions that stay inside, for each set of sides on which a point can lie: bit 2a is the
// low and bit 2a + 1 the high side of axis a (both are set where the count is 1).
constexpr std::array<DirectionMask, 64> kInside = [] {
  std::array<DirectionMask, 64> inside{};
  for (unsigned sides = 0; sides < inside.size(); ++sides) {
    for (int q = 0; q < kDirections; ++q) {
      const auto step = Direction(q).step();
      bool leaves = false;
      for (int a = 0; a < 3; ++a) {
        leaves |= step[a] < 0 && (sides >> (2 * a) & 1);
        leaves |= step[a] > 0 && (sides >> (2 * a + 1) & 1);
      }
      if (!leaves) inside[sides] |= DirectionMask{1} << q;
    }
  }
  return inside;
}();

}  // namespace

void Box::validate() const {
  if (!finite(origin)) throw Error("box: origin is not finite");
  for (int a = 0; a < 3; ++a) {
    if (counts[a] == 0) throw Error("box: a count is 0; each axis needs at least one point");
  }
  if (!std::isfinite(spacing) || spacing <= 0)
    throw Error(format("box: spacing is {:f}, it must be positive", spacing));
  constexpr std::uint64_t kLimit = std::numeric_limits<PointIndex>::max();
  // Two factors are tested first: the product of three 32-bit counts can overflow 64 bits.
  if (std::uint64_t{counts[0]} * counts[1] > kLimit || points() > kLimit)
    throw Error("box: more than 4294967295 grid points");
}

Neighbourhood::Neighbourhood(const Box& box) : box_(box) {
  const std::int64_t nx = box.counts[0];
  const std::int64_t ny = box.counts[1];
  for (int q = 0; q < kDirections; ++q) {
    const auto step = Direction(q).step();
    offset_[q] = step[0] + nx * (step[1] + ny * step[2]);
    reach_ = std::max(reach_, std::abs(offset_[q]));
    for (int a = 0; a < 3; ++a) shift_[q][a] = box.spacing * step[a];
  }
}

DirectionMask Neighbourhood::inside(const GridCoordinates& c) const {
  unsigned sides = 0;
  for (int a = 0; a < 3; ++a) {
    sides |= unsigned{c[a] == 0} << (2 * a);
    sides |= unsigned{c[a] + 1 == box_.counts[a]} << (2 * a + 1);
  }
  return kInside[sides];
}

}  // namespace hapgrid
