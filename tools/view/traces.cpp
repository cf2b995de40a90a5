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

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double magnitude(const Vec3& v) { return std::hypot(v[0], v[1], v[2]); }

}  // namespace

void Traces::add(const Frame& frame) {
  if (!samples_.empty() && frame.time_s < samples_.back().time_s) samples_.clear();
  const bool snapped = !samples_.empty() && frame.jumps != jumps_;
  jumps_ = frame.jumps;
  samples_.push_back(
      {frame.time_s, magnitude(frame.force), frame.energy, snapped, frame.own_energy});
  while (samples_.size() > kMaxSamples || samples_.front().time_s < frame.time_s - kSeconds)
    samples_.pop_front();
}

Extent force_extent(const Traces& traces) {
  double high = 0;
  for (const auto& s : traces.samples())
    if (std::isfinite(s.force)) high = std::max(high, s.force);
  return {0, high > 0 ? high : 1};
}

Extent energy_extent(const Traces& traces) {
  Extent extent{kNan, kNan};
  for (const auto& s : traces.samples()) {
    for (const double energy : {s.energy, s.own_energy}) {
      if (!std::isfinite(energy)) continue;
      extent.low = std::fmin(extent.low, energy);
      extent.high = std::fmax(extent.high, energy);
    }
  }
  // As much as three digits show: what changes less is a straight line.
  const double least = 1e-3 * std::abs(extent.low);
  if (extent.high - extent.low < least) extent.high = extent.low + least;
  if (extent.high == extent.low) extent.high = extent.low + 1;
  return extent;
}

std::vector<Column> columns(const Traces& traces, int count) {
  std::vector<Column> result(static_cast<std::size_t>(count), Column{kNan, kNan});
  if (result.empty() || traces.samples().empty()) return result;
  const double end = traces.samples().back().time_s;
  std::vector<bool> any(result.size());
  for (const auto& s : traces.samples()) {
    const double from_left = (1 - (end - s.time_s) / Traces::kSeconds) * count;
    // The newest sample belongs to the last column, which ends there.
    const auto i = static_cast<std::size_t>(std::clamp<double>(from_left, 0, count - 1));
    Column& column = result[i];
    column.force = any[i] ? std::fmax(column.force, s.force) : s.force;
    column.energy = s.energy;
    column.snapped = column.snapped || s.snapped;
    any[i] = true;
  }
  for (std::size_t i = 1; i < result.size(); ++i)
    if (!any[i]) result[i] = {result[i - 1].force, result[i - 1].energy, false};
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
