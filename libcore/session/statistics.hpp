// A session in numbers.
#pragma once

#include <array>
#include <cstdint>

#include "libcore/base/histogram.hpp"
#include "libcore/session/session.hpp"

namespace hapgrid {

/// The largest magnitude of a force.
struct LargestForce {
  double newtons = 0;
  std::uint64_t tick = 0;  ///< the first one that had it
  bool any = false;        ///< false: no force was finite
};

/// Counts of the ticks that were added, in order.
struct SessionStatistics {
  std::uint64_t ticks = 0;
  std::uint64_t first = 0;    ///< number
  std::uint64_t last = 0;     ///< number
  std::uint64_t skipped = 0;  ///< numbers between them that are not there: missed or dropped
  LargestForce raw;
  LargestForce sent;
  std::uint64_t not_computed = 0;                ///< ticks without a raw force
  std::array<std::uint64_t, kMaxFlags> flags{};  ///< ticks in which the flag was set
  Histogram lateness;
  Histogram compute;

  void add(const TickRecord& tick);
};

}  // namespace hapgrid
