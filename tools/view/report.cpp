#include "tools/view/report.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/format.hpp"
#include "libcore/base/table.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

void widen(SceneReport::Range& range, double low, double high) {
  range = {std::min(range.first, low), std::max(range.second, high)};
}

std::string range_text(const SceneReport::Range& r) {
  return format("{} .. {}", rounded(r.first), rounded(r.second));
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : format("{} {}", text, printable_line(unit));
}

}  // namespace

void SceneReport::add(const Scene& scene, const Frame& frame) {
  if (frames++ == 0) first_s = frame.time_s;
  last_s = frame.time_s;
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    const float* centre = frame.centres.data() + 3 * i;
    if (!std::all_of(centre, centre + 3, [](float x) { return std::isfinite(x); })) continue;
    const double r = scene.spheres[i].radius;
    const bool first = !bounds;
    if (first) bounds.emplace();
    for (std::size_t a = 0; a < 3; ++a) {
      if (first) (*bounds)[a] = {centre[a], centre[a]};
      widen((*bounds)[a], centre[a] - r, centre[a] + r);
    }
  }
  const double force = length_of(frame.force);
  if (force > largest_force) {
    largest_force = force;
    largest_force_s = frame.time_s;
  }
  if (!std::isfinite(frame.energy)) return;
  if (!energy) energy = Range{frame.energy, frame.energy};
  widen(*energy, frame.energy, frame.energy);
}

std::string SceneReport::text(const Scene& scene) const {
  std::string text;
  const auto row = [&](const std::string& name, const std::string& value) {
    text += format("{}{}\n", left(name, 9), value);
  };
  row("model", printable_line(scene.model));
  row("frames", frames == 0
                    ? "0"
                    : format("{}, from {} s to {} s", frames, rounded(first_s), rounded(last_s)));
  std::string spheres = format("{}", scene.spheres.size());
  if (bounds)
    spheres = with_unit(format("{}, in x {}, y {}, z {}", spheres, range_text((*bounds)[0]),
                               range_text((*bounds)[1]), range_text((*bounds)[2])),
                        scene.length_unit);
  row("spheres", spheres);
  row("force", largest_force > 0 ? format("at most {} N, at {} s", rounded(largest_force),
                                          rounded(largest_force_s))
                                 : "none");
  if (energy) row("energy", with_unit(range_text(*energy), scene.energy_unit));
  return text;
}

}  // namespace hapgrid
