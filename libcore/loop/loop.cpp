#include "libcore/loop/loop.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hapgrid {

namespace {

double magnitude(const Vec3& f) { return std::hypot(f[0], f[1], f[2]); }

}  // namespace

std::uint64_t LoopSummary::count_of(SafetyAction action) const {
  return acted[std::countr_zero(static_cast<std::uint32_t>(action))];
}

void LoopSummary::count(const Tick& tick) noexcept {
  const StepResult& step = tick.step;
  ++ticks;
  face_switches += step.face_switches;
  edge_switches += step.edge_switches;
  vertex_switches += step.vertex_switches;
  level_changed += step.level_changed;
  outside += step.outside;
  split += step.split;
  lagging += step.lagging;
  not_finite += step.not_finite;
  blocked += step.blocked;
  for (std::size_t i = 0; i < kSafetyActions; ++i) acted[i] += (tick.force.acted >> i) & 1;
  largest_raw = std::max(largest_raw, magnitude(tick.raw_force));  // a NaN changes nothing
  largest_force = std::max(largest_force, magnitude(tick.force.force));
  lateness.add(tick.lateness_ns);
  compute.add(tick.compute_ns);
}

}  // namespace hapgrid
