#include "libcore/session/recorder.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/base/signals.hpp"

namespace hapgrid {

namespace {

constexpr std::chrono::milliseconds kPeriod{20};

/// Ticks that the ring holds: what comes in 8 s, longer than a disk that is busy keeps a writer
/// waiting; at most 64 MiB.
std::size_t ring_capacity(double rate_hz) {
  constexpr double kSeconds = 8;
  constexpr double kMost = (64 << 20) / sizeof(TickRecord);
  return static_cast<std::size_t>(
      std::clamp(std::ceil(kSeconds * rate_hz), double{kChunkTicks}, kMost));
}

}  // namespace

SessionRecorder::SessionRecorder(const std::string& name, const SessionHeader& header, bool paced)
    : writer_(name, header) {
  if (!paced) return;
  ring_.emplace(ring_capacity(header.rate_hz));
  const BlockedSignals blocked;
  slow_ = std::jthread([this](const std::stop_token& token) { run(token); });
}

SessionRecorder::~SessionRecorder() = default;

bool SessionRecorder::add(const TickRecord& tick) noexcept {
  bool kept = !failed_.load(std::memory_order_relaxed);
  if (kept && ring_) {
    kept = ring_->push(tick);
  } else if (kept) {
    try {
      writer_.add(tick);
    } catch (...) {
      failure_ = std::current_exception();
      failed_.store(true, std::memory_order_relaxed);
      kept = false;
    }
  }
  if (!kept) ++dropped_;
  return kept;
}

/// The slow thread.
void SessionRecorder::run(const std::stop_token& token) {
  // A thread inherits the real-time priority of who starts it.
  const sched_param normal{};
  static_cast<void>(::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &normal));
  try {
    for (;;) {
      const bool last = token.stop_requested();  // asked first: then nothing newer can come
      drain();
      if (last) return;
      std::this_thread::sleep_for(kPeriod);
    }
  } catch (...) {
    failure_ = std::current_exception();
    failed_.store(true, std::memory_order_relaxed);
  }
}

void SessionRecorder::drain() {
  for (auto ticks = ring_->peek(); !ticks.empty(); ticks = ring_->peek()) {
    // Written ticks leave the ring at once, so that it has room while a large backlog is written.
    ticks = ticks.first(std::min<std::size_t>(ticks.size(), kChunkTicks));
    for (const TickRecord& tick : ticks) writer_.add(tick);
    ring_->pop(ticks.size());
  }
}

SessionCounts SessionRecorder::finish() {
  if (slow_.joinable()) {
    slow_.request_stop();
    slow_.join();
  }
  const std::string part = writer_.part();
  try {
    if (failure_) std::rethrow_exception(failure_);
    writer_.finish(dropped_);
  } catch (const std::exception& e) {
    if (part.empty() || !writer_.any_written()) throw;
    throw Error(std::string(e.what()) + "; what was recorded before is in " + part +
                ", for stats --salvage");
  }
  return {writer_.ticks(), dropped_};
}

}  // namespace hapgrid
