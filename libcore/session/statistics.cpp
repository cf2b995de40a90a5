#include "libcore/session/statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hapgrid {

namespace {

/// Of times with `bits` bits, 9 or more, the upper 8 are told apart: the highest is always set.
std::size_t bucket_of(std::uint32_t ns) {
  if (ns < 256) return ns;
  const auto bits = static_cast<unsigned>(std::bit_width(ns));
  return 256 + (bits - 9) * 128 + ((ns >> (bits - 8)) - 128);
}

/// The largest time in a bucket.
std::uint32_t upper_end(std::size_t bucket) {
  if (bucket < 256) return static_cast<std::uint32_t>(bucket);
  const std::size_t shift = (bucket - 256) / 128 + 1;
  const std::uint64_t leading = (bucket - 256) % 128 + 128;
  return static_cast<std::uint32_t>(((leading + 1) << shift) - 1);
}

void take_largest(LargestForce& largest, const Vec3& force, std::uint64_t tick) {
  const double newtons = std::hypot(force[0], force[1], force[2]);
  if (!std::isfinite(newtons) || (largest.any && newtons <= largest.newtons)) return;
  largest = {newtons, tick, true};
}

}  // namespace

void TimeHistogram::add(std::uint32_t ns) {
  ++counts_[bucket_of(ns)];
  ++sum_;
  max_ = std::max(max_, ns);
}

std::uint32_t TimeHistogram::percentile(double share) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(sum_)));
  std::uint64_t count = 0;
  for (std::size_t b = 0; b < kBuckets; ++b) {
    count += counts_[b];
    if (count > 0 && count >= wanted) return std::min(upper_end(b), max_);
  }
  return max_;
}

void SessionStatistics::add(const TickRecord& tick) {
  if (ticks == 0)
    first = tick.number;
  else
    skipped += tick.number - last - 1;
  last = tick.number;
  ++ticks;
  take_largest(raw, tick.raw_force, tick.number);
  take_largest(sent, tick.force, tick.number);
  if (std::isnan(tick.raw_force[0]) || std::isnan(tick.raw_force[1]) ||
      std::isnan(tick.raw_force[2]))
    ++not_computed;
  for (std::uint32_t left = tick.flags; left != 0; left &= left - 1)
    ++flags[static_cast<std::size_t>(std::countr_zero(left))];
  lateness.add(tick.lateness_ns);
  compute.add(tick.compute_ns);
}

}  // namespace hapgrid
