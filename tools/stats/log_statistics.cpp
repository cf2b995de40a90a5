#include "tools/stats/log_statistics.hpp"

#include <bit>
#include <cmath>

namespace hapgrid {

namespace {

void keep_larger(LargestForce& largest, const Vec3& force, std::uint64_t tick) {
  const double newtons = std::hypot(force[0], force[1], force[2]);
  if (!std::isfinite(newtons) || (largest.any && newtons <= largest.newtons)) return;
  largest = {newtons, tick, true};
}

}  // namespace

void HandEnergy::add(const TickRecord& tick) {
  const bool begins = begins_ < kMaxFlags && (tick.flags >> begins_ & 1) != 0;
  if (begins || !any_) {
    since_begin_ = 0;
  } else {
    double work = 0;
    for (int a = 0; a < 3; ++a) work += last_.force[a] * (tick.hip[a] - last_.hip[a]);
    if (std::isfinite(work)) {  // a HIP that is not finite is no place
      given_ += work;
      since_begin_ += work;
    }
  }
  if (!any_) returned_tick_ = tick.number;
  if (since_begin_ > returned_) {
    returned_ = since_begin_;
    returned_tick_ = tick.number;
  }
  any_ = true;
  last_ = tick;
}

void SessionStatistics::add(const TickRecord& tick) {
  if (ticks == 0)
    first = tick.number;
  else
    skipped += tick.number - last - 1;
  last = tick.number;
  ++ticks;
  keep_larger(raw, tick.raw_force, tick.number);
  keep_larger(sent, tick.force, tick.number);
  if (std::isnan(tick.raw_force[0]) || std::isnan(tick.raw_force[1]) ||
      std::isnan(tick.raw_force[2]))
    ++not_computed;
  for (std::uint32_t left = tick.flags; left != 0; left &= left - 1)
    ++flags[static_cast<std::size_t>(std::countr_zero(left))];
  lateness.add(tick.lateness_ns);
  compute.add(tick.compute_ns);
}

}  // namespace hapgrid
