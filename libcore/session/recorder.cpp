#include "libcore/session/recorder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/signals.hpp"

namespace hapgrid {

SessionWriter::SessionWriter(const std::string& name, const SessionHeader& header) : name_(name) {
  const MessageWords message = encode_header(header);
  file_ = FileDescriptor(::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file_) throw std::system_error(errno, std::generic_category(), name);
  rows_.reserve(kChunkTicks);
  write(message);
}

void SessionWriter::write(const MessageWords& message) {
  write_all(file_.get(), frames_.encode(std::as_bytes(std::span(message))), name_);
}

void SessionWriter::write_chunk(std::uint64_t dropped) {
  write(encode_ticks(rows_, dropped));
  rows_.clear();
}

void SessionWriter::add(const TickRecord& tick, std::uint64_t dropped) {
  if (ticks_ > 0 && tick.number <= last_)
    throw Error(format("{}: tick {} after tick {}", name_, tick.number, last_));
  // A full chunk waits for the next tick, so that finish() always has one to tell `dropped` with.
  if (rows_.size() == kChunkTicks) write_chunk(dropped);
  ++ticks_;
  last_ = tick.number;
  rows_.push_back(tick);
}

void SessionWriter::finish(std::uint64_t dropped) {
  if (!rows_.empty()) write_chunk(dropped);
  // EINVAL: a device or a pipe, which has no disk.
  if (::fsync(file_.get()) != 0 && errno != EINVAL)
    throw std::system_error(errno, std::generic_category(), name_);
  file_ = FileDescriptor();  // The reader of a pipe waits for its end.
}

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
