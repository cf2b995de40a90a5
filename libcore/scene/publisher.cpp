#include "libcore/scene/publisher.hpp"

#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

namespace hapgrid {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::nanoseconds kPeriod{1'000'000'000 / kFramesPerSecond};
constexpr std::chrono::seconds kLinger{1};

Snapshot empty_snapshot(std::size_t row_size) {
  Snapshot snapshot;
  snapshot.row.resize(row_size);
  return snapshot;
}

/// While it lives signals are blocked: a thread that is started now never gets one. The handlers of
/// play have to interrupt the haptic loop, which is another thread.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

FramePublisher::FramePublisher(OutputFile output, const Scene& scene, std::size_t row_size,
                               Complete complete, bool paced, double ticks_per_second,
                               const std::atomic<int>& stop)
    : output_(std::move(output)),
      scene_(scene),
      complete_(std::move(complete)),
      paced_(paced),
      ticks_per_frame_(static_cast<std::uint64_t>(
          std::max(1.0, std::round(ticks_per_second / kFramesPerSecond)))),
      stopped_([&stop] { return stop.load(std::memory_order_relaxed) != 0; }),
      buffer_(empty_snapshot(row_size)) {
  static_cast<Snapshot&>(frame_) = buffer_.front();
  frame_.centres.resize(3 * scene.spheres.size());
  encoder_.encode(frame_, scene_.state_size);  // takes the memory for all of them
  if (!paced_) {
    write(encoder_.encode(scene_), stopped_);
    return;
  }
  const BlockedSignals blocked;
  slow_ = std::jthread([this](const std::stop_token& token) {
    try {
      run(token);
    } catch (...) {
      failure_ = std::current_exception();
    }
  });
}

FramePublisher::~FramePublisher() = default;

void FramePublisher::publish() {
  if (paced_) {
    buffer_.publish();
    return;
  }
  left_ = buffer_.back().tick < due_;
  if (left_) return;
  due_ = (buffer_.back().tick / ticks_per_frame_ + 1) * ticks_per_frame_;
  buffer_.publish();
  write_newest(stopped_);
}

FrameCounts FramePublisher::finish() {
  if (paced_) {
    slow_.request_stop();
    slow_.join();
    if (failure_) std::rethrow_exception(failure_);
  } else if (left_) {
    buffer_.publish();
    write_newest(stopped_);
  }
  output_.commit();
  return counts_;
}

/// The slow thread.
void FramePublisher::run(const std::stop_token& token) {
  std::optional<Clock::time_point> patience;
  const GiveUp give_up = [&] {
    if (!token.stop_requested()) return false;
    if (!patience) patience = Clock::now() + kLinger;
    return Clock::now() >= *patience;
  };
  const auto start = Clock::now();
  if (!write(encoder_.encode(scene_), give_up)) return;
  for (std::uint64_t due = 0;;) {
    const bool last = token.stop_requested();  // asked first: then nothing newer can come
    const bool open = write_newest(give_up);
    const auto late = static_cast<std::uint64_t>((Clock::now() - start) / kPeriod);
    if (late > due) counts_.dropped += late - due;
    if (!open || last) return;
    due = std::max(due, late) + 1;
    std::this_thread::sleep_until(start + due * kPeriod);
  }
}

bool FramePublisher::write(std::span<const std::byte> message, const GiveUp& give_up) {
  switch (output_.write(message, give_up)) {
    case FrameOutput::Status::kWritten:
      return true;
    case FrameOutput::Status::kClosed:
      counts_.closed = true;
      return false;
    case FrameOutput::Status::kGivenUp:
      counts_.cut = true;
      break;
  }
  return false;
}

/// Completes and writes the newest snapshot, if there is a new one.
bool FramePublisher::write_newest(const GiveUp& give_up) {
  if (counts_.closed || counts_.cut) return false;
  if (!buffer_.update()) return true;
  static_cast<Snapshot&>(frame_) = buffer_.front();  // vectors keep their sizes: no allocation
  complete_(frame_);
  if (!write(encoder_.encode(frame_, scene_.state_size), give_up)) return false;
  ++counts_.written;
  return true;
}

}  // namespace hapgrid
