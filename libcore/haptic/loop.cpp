#include "libcore/haptic/loop.hpp"

#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace hapgrid {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::int64_t now_ns() noexcept {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond + t.tv_nsec;
}

}  // namespace

std::uint64_t Pacer::tick_at(std::int64_t nanoseconds) const noexcept {
  return static_cast<std::uint64_t>(static_cast<double>(nanoseconds) * rate_hz_ / kSecond);
}

std::uint64_t Pacer::wait(const std::atomic<int>& stop) noexcept {
  if (rate_hz_ == 0) return next_++;
  if (!started_) {
    started_ = true;
    start_ns_ = now_ns();
    return next_++;
  }
  const std::uint64_t due = next_;
  // The period of the tick before is over: the first deadline that is still ahead.
  next_ = std::max(due, tick_at(now_ns() - start_ns_) + 1);
  const auto offset =
      static_cast<std::int64_t>(std::ceil(static_cast<double>(next_) / rate_hz_ * kSecond));
  const std::int64_t deadline = start_ns_ + offset;
  const timespec until{deadline / kSecond, deadline % kSecond};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR)
    if (stop.load(std::memory_order_relaxed) != 0) break;
  // Woken a period late or more, it is another tick by now.
  next_ = std::max(next_, tick_at(now_ns() - start_ns_));
  missed_ += next_ - due;
  return next_++;
}

void LoopSummary::count(const StepResult& step, const SafeForce& force) noexcept {
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
  clamped += force.clamped;
  faulted += force.faulted;
}

}  // namespace hapgrid
