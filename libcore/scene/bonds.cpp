#include "libcore/scene/bonds.hpp"

#include <cstddef>

namespace hapgrid {

namespace {

constexpr std::size_t kMostSpheres = 4096;
constexpr float kPart = 0.6F;  // of the sum of two radii

}  // namespace

std::vector<std::array<std::uint32_t, 2>> find_bonds(const Scene& scene, const Frame& frame) {
  std::vector<std::array<std::uint32_t, 2>> bonds;
  const auto count = static_cast<std::uint32_t>(scene.spheres.size());
  if (count > kMostSpheres) return bonds;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float* a = frame.centres.data() + 3 * i;
    for (std::uint32_t j = i + 1; j < count; ++j) {
      const float* b = frame.centres.data() + 3 * j;
      const float reach = kPart * (scene.spheres[i].radius + scene.spheres[j].radius);
      float square = 0;
      for (int k = 0; k < 3; ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
      if (square < reach * reach) bonds.push_back({i, j});  // false for what is not finite
    }
  }
  return bonds;
}

}  // namespace hapgrid
