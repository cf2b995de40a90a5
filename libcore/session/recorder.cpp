#include "libcore/session/recorder.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libcore/base/signals.hpp"

namespace hapgrid {

namespace {

constexpr std::chrono::milliseconds kPeriod{20};

/// The ring has room for the ticks of 8 s, because a busy disk keeps a writer waiting for less; at
/// most 64 MiB.
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
      writer_.add(tick, dropped());
    } catch (...) {
      failure_ = std::current_exception();
      failed_.store(true, std::memory_order_relaxed);
      kept = false;
    }
  }
  if (!kept) dropped_.fetch_add(1, std::memory_order_relaxed);
  return kept;
}

/// The slow thread.
void SessionRecorder::run(const std::stop_token& token) {
  try {
    for (;;) {
      const bool last =
          token.stop_requested();  // Asked before drain(), which then finds all ticks.
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
    for (const TickRecord& tick : ticks) writer_.add(tick, dropped());
    ring_->pop(ticks.size());
  }
}

std::uint64_t SessionRecorder::finish() {
  if (slow_.joinable()) {
    slow_.request_stop();
    slow_.join();
  }
  if (failure_) std::rethrow_exception(failure_);
  writer_.finish(dropped());
  return writer_.ticks();
}

}  // namespace hapgrid
