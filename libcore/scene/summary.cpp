#include "libcore/scene/summary.hpp"

#include <algorithm>
#include <cmath>

namespace hapgrid {

void SceneSummary::add(const Scene& scene, const Frame& frame) {
  if (frames++ == 0) first_s = frame.time_s;
  last_s = frame.time_s;
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const float* centre = frame.centres.data() + 3 * i;
    if (!std::all_of(centre, centre + 3, [](float x) { return std::isfinite(x); })) continue;
    const double r = scene.spheres[i].radius;
    if (!bounds) {
      bounds.emplace();
      for (int a = 0; a < 3; ++a) (*bounds)[a] = {centre[a] - r, centre[a] + r};
    }
    for (int a = 0; a < 3; ++a) {
      Range& range = (*bounds)[a];
      range.first = std::min(range.first, centre[a] - r);
      range.second = std::max(range.second, centre[a] + r);
    }
  }
  const double force = std::hypot(frame.force[0], frame.force[1], frame.force[2]);
  if (force > largest_force) {
    largest_force = force;
    largest_force_s = frame.time_s;
  }
  if (!std::isfinite(frame.energy)) return;
  if (!energy) energy = Range{frame.energy, frame.energy};
  energy->first = std::min(energy->first, frame.energy);
  energy->second = std::max(energy->second, frame.energy);
}

}  // namespace hapgrid
