#include "libcore/loop/pacer.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>

namespace hapgrid {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kLongestAwake = kSecond / 2;
constexpr std::int64_t kNap = 50'000;

}  // namespace

std::int64_t monotonic_ns() noexcept {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond + t.tv_nsec;
}

void Clock::sleep_until(std::int64_t nanoseconds) noexcept {
  const timespec until{nanoseconds / kSecond, nanoseconds % kSecond};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

Pacer::Pacer(Clock& clock, double rate_hz, double spin_us)
    : clock_(clock), rate_hz_(rate_hz), spin_ns_(static_cast<std::int64_t>(spin_us * 1000)) {}

std::uint64_t Pacer::tick_at(std::int64_t nanoseconds) const noexcept {
  return static_cast<std::uint64_t>(static_cast<double>(nanoseconds) * rate_hz_ / kSecond);
}

std::uint64_t Pacer::wait(const std::atomic<int>& stop) noexcept {
  if (rate_hz_ == 0 || !started_) {
    began_ns_ = clock_.now();
    if (!started_) start_ns_ = slept_ns_ = began_ns_;
    started_ = true;
    return next_++;
  }
  if (const std::int64_t now = clock_.now(); now - slept_ns_ > kLongestAwake) {
    clock_.sleep_until(now + kNap);
    slept_ns_ = clock_.now();
  }
  // The first deadline that is still ahead.
  next_ = std::max(next_, tick_at(clock_.now() - start_ns_) + 1);
  const std::int64_t due_ns =
      start_ns_ +
      static_cast<std::int64_t>(std::ceil(static_cast<double>(next_) / rate_hz_ * kSecond));
  while (clock_.now() < due_ns - spin_ns_ && stop.load(std::memory_order_relaxed) == 0) {
    clock_.sleep_until(due_ns - spin_ns_);
    slept_ns_ = due_ns - spin_ns_;
  }
  do {
    began_ns_ = clock_.now();
  } while (began_ns_ < due_ns && stop.load(std::memory_order_relaxed) == 0);
  lateness_ns_ = std::max<std::int64_t>(0, began_ns_ - due_ns);
  // A thread that woke up a period late or more is in a later tick by now.
  next_ = std::max(next_, tick_at(began_ns_ - start_ns_));
  return next_++;
}

}  // namespace hapgrid
