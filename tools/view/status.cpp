#include "tools/view/status.hpp"

#include <cmath>

#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/scene/scene.hpp"

namespace hapgrid {

namespace {

std::string three_digits(double value) { return format("{:.3g}", value); }

}  // namespace

std::string status_text(const Scene& scene, const Frame& frame) {
  std::string text =
      format("t {} s   force {} N",
             std::abs(frame.time_s) < 1e9 ? fixed(frame.time_s, 2) : three_digits(frame.time_s),
             three_digits(length_of(frame.force)));
  const bool has_own = std::isfinite(frame.own_energy);
  if (const double energy = has_own ? frame.own_energy : frame.energy; std::isfinite(energy)) {
    text += "   energy " + three_digits(energy);
    if (!scene.energy_unit.empty()) text += " " + counted_unit(scene.energy_unit, energy);
    if (has_own) text += " of the model alone, " + three_digits(frame.energy) + " with the hand";
  }
  std::size_t farthest = frame.turned.size();
  for (std::size_t i = 0; i < frame.turned.size(); ++i)
    if (std::abs(frame.turned[i]) >= (farthest < i ? std::abs(frame.turned[farthest]) : kTurned))
      farthest = i;
  if (farthest < frame.turned.size())
    text += "   " + torsion_text(scene.torsions[farthest], frame.angles[farthest]);
  return text;
}

}  // namespace hapgrid
