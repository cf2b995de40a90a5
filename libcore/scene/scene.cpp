#include "libcore/scene/scene.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libcore/base/text.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

double torsion_degrees(const Torsion& torsion, std::span<const float> centres) {
  std::array<Vec3, 3> way;  // from each sphere to the next
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t a = 0; a < 3; ++a)
      way[k][a] = static_cast<double>(centres[3 * torsion.spheres[k + 1] + a]) -
                  static_cast<double>(centres[3 * torsion.spheres[k] + a]);
  const Vec3 m = cross(way[0], way[1]);
  const Vec3 n = cross(way[1], way[2]);
  if (!(dot(m, m) > 0 && dot(n, n) > 0)) return std::numeric_limits<double>::quiet_NaN();
  const double sine = dot(way[0], n) * std::sqrt(dot(way[1], way[1]));
  return std::atan2(sine, dot(m, n)) * 180 / std::numbers::pi;
}

std::string torsion_text(const Torsion& torsion, double degrees) {
  return printable_line(torsion.name, 24) + (degrees < 0 ? " −" : " +") +
         fixed(std::abs(degrees), 0) + "°";
}

}  // namespace hapgrid
