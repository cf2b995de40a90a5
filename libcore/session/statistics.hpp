// A session in numbers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libcore/session/session.hpp"

namespace hapgrid {

/// How often each time occurred, in memory that does not grow: exact below 256 ns, in steps of
/// 1/128 above.
class TimeHistogram {
 public:
  TimeHistogram() : counts_(kBuckets) {}

  void add(std::uint32_t ns);
  /// The smallest time that at least this share of all times are not above, in (0, 1]: not below
  /// the true one, and at most 1 % above it. 0 without times.
  std::uint32_t percentile(double share) const;
  /// Exact; 0 without times.
  std::uint32_t max() const { return max_; }

 private:
  static constexpr std::size_t kBuckets = 256 + 24 * 128;  // 2^8 up to 2^32

  std::vector<std::uint64_t> counts_;
  std::uint64_t sum_ = 0;
  std::uint32_t max_ = 0;
};

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
  TimeHistogram lateness;
  TimeHistogram compute;

  void add(const TickRecord& tick);
};

}  // namespace hapgrid
