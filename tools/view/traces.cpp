#include "tools/view/traces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcore/base/format.hpp"
#include "libcore/base/table.hpp"
#include "libcore/base/text.hpp"
#include "libcore/scene/torsion.hpp"

namespace hapgrid {

namespace {

double magnitude(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

}  // namespace

void Traces::add(const Frame& frame) {
  if (!samples_.empty() && frame.time_s < samples_.back().time_s) samples_.clear();
  const bool snapped = !samples_.empty() && frame.jumps != jumps_;
  jumps_ = frame.jumps;
  samples_.push_back({frame.time_s, magnitude(frame.force), frame.energy, snapped});
  while (samples_.size() > kMaxSamples || samples_.front().time_s < frame.time_s - kSeconds)
    samples_.pop_front();
}

std::vector<Traces::Sample> Traces::columns(int count) const {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Sample> result(static_cast<std::size_t>(count), Sample{0, kNan, kNan});
  if (result.empty() || samples_.empty()) return result;
  const double end = samples_.back().time_s;
  std::vector<bool> any(result.size());
  for (const Sample& s : samples_) {
    const double from_left = (1 - (end - s.time_s) / kSeconds) * count;
    // The newest sample belongs to the last column, which ends there.
    const auto i = static_cast<std::size_t>(std::clamp<double>(from_left, 0, count - 1));
    const Sample before = result[i];
    result[i] = s;
    if (any[i]) result[i].force = std::fmax(before.force, s.force);
    result[i].snapped = before.snapped || s.snapped;
    any[i] = true;
  }
  for (std::size_t i = 1; i < result.size(); ++i)
    if (!any[i]) result[i] = {0, result[i - 1].force, result[i - 1].energy};
  return result;
}

std::string status_text(const Scene& scene, const Frame& frame) {
  std::string text =
      format("t {} s   force {} N",
             std::abs(frame.time_s) < 1e9 ? fixed(frame.time_s, 2) : three_digits(frame.time_s),
             three_digits(magnitude(frame.force)));
  if (std::isfinite(frame.energy)) {
    text += "   energy " + three_digits(frame.energy);
    if (!scene.energy_unit.empty()) text += " " + printable_line(scene.energy_unit);
  }
  if (std::isfinite(frame.own_energy)) text += "   model alone " + three_digits(frame.own_energy);
  std::size_t farthest = frame.turned.size();
  for (std::size_t i = 0; i < frame.turned.size(); ++i)
    if (std::abs(frame.turned[i]) >= (farthest < i ? std::abs(frame.turned[farthest]) : kTurned))
      farthest = i;
  if (farthest < frame.turned.size())
    text += "   " + turned_text(scene.torsions[farthest], frame.turned[farthest]);
  return text;
}

}  // namespace hapgrid
