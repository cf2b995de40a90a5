// When ticks are due: at start + k / rate, so that no error adds up. A tick that was missed is
// skipped and counted; the loop never catches up.
#pragma once

#include <atomic>
#include <cstdint>

namespace hapgrid {

/// CLOCK_MONOTONIC in nanoseconds. Real-time safe.
std::int64_t monotonic_ns() noexcept;

/// The time that a loop keeps to; a test has one of its own. Real-time safe.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual std::int64_t now() noexcept { return monotonic_ns(); }
  /// Returns at that time, or earlier because of a signal.
  virtual void sleep_until(std::int64_t nanoseconds) noexcept;
};

class Pacer {
 public:
  /// @param rate_hz ticks a second; 0: not paced, each tick is due at once.
  /// @param spin_us the thread wakes up this long before the tick is due and waits awake: its ticks
  /// are less late, at the price of spin_us * rate_hz of a processor.
  /// @param clock outlives this.
  Pacer(Clock& clock, double rate_hz, double spin_us = 0);

  /// Waits for the next tick and returns its number k; returns early when `stop` becomes nonzero
  /// through a signal's handler. A thread that always waits awake, or is always late, sleeps for a
  /// moment each half second all the same: see kLongestBusy in realtime.hpp. Real-time safe.
  std::uint64_t wait(const std::atomic<int>& stop) noexcept;

  /// How long after its due time the last tick began, in nanoseconds; 0 when not paced.
  std::int64_t lateness_ns() const { return lateness_ns_; }
  /// When the last tick began; CLOCK_MONOTONIC, nanoseconds.
  std::int64_t began_ns() const { return began_ns_; }

 private:
  /// The tick in whose period `nanoseconds` after the start lies.
  std::uint64_t tick_at(std::int64_t nanoseconds) const noexcept;

  Clock& clock_;
  double rate_hz_;
  std::int64_t spin_ns_;
  bool started_ = false;
  std::int64_t start_ns_ = 0;  // CLOCK_MONOTONIC
  std::int64_t began_ns_ = 0;
  std::int64_t slept_ns_ = 0;  // until when
  std::int64_t lateness_ns_ = 0;
  std::uint64_t next_ = 0;
};

}  // namespace hapgrid
