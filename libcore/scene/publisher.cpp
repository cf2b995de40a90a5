#include "libcore/scene/publisher.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "libcore/base/signals.hpp"

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

}  // namespace

FramePublisher::FramePublisher(std::optional<OutputFile> output, const Scene& scene,
                               std::size_t row_size, Complete complete, bool paced,
                               double ticks_per_second, const std::atomic<int>& stop, Show show)
    : scene_(scene),
      complete_(std::move(complete)),
      show_(std::move(show)),
      paced_(paced),
      ticks_per_frame_(static_cast<std::uint64_t>(
          std::max(1.0, std::round(ticks_per_second / kFramesPerSecond)))),
      stopped_([&stop] { return stop.load(std::memory_order_relaxed) != 0; }),
      buffer_(empty_snapshot(row_size)) {
  if (output) output_.emplace(std::move(*output));
  static_cast<Snapshot&>(frame_) = buffer_.front();
  frame_.centres.resize(3 * scene.spheres.size());
  if (output_) encoder_.encode(frame_, scene_.state_size);  // takes the memory for all of them
  if (!paced_) {
    write_scene(stopped_);
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
  if (output_) output_->commit();
  return counts_;
}

/// The slow thread.
void FramePublisher::run(const std::stop_token& token) {
  const auto start = Clock::now();
  std::optional<Clock::time_point> patience;
  std::uint64_t shown = 0;  // periods
  const GiveUp give_up = [&] {
    // The other viewers get frames even while the file's viewer sleeps.
    const auto period = static_cast<std::uint64_t>((Clock::now() - start) / kPeriod);
    if (show_ && period > shown) {
      shown = period;
      complete_newest();
    }
    if (!token.stop_requested()) return false;
    if (!patience) patience = Clock::now() + kLinger;
    return Clock::now() >= *patience;
  };
  write_scene(give_up);
  for (std::uint64_t due = 0;;) {
    const bool last = token.stop_requested();  // asked first: then nothing newer can come
    const bool was_open = open();
    write_newest(give_up);
    const auto late = static_cast<std::uint64_t>((Clock::now() - start) / kPeriod);
    if (was_open && late > due) counts_.dropped += late - due;
    if (last || (!open() && !show_)) return;
    due = std::max(due, late) + 1;
    shown = std::max(shown, due);
    std::this_thread::sleep_until(start + due * kPeriod);
  }
}

void FramePublisher::write_scene(const GiveUp& give_up) {
  if (output_) write(encoder_.encode(scene_), give_up);
}

bool FramePublisher::write(std::span<const std::byte> message, const GiveUp& give_up) {
  switch (output_->write(message, give_up)) {
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

/// Completes and shows the newest snapshot, if there is a new one.
void FramePublisher::complete_newest() {
  if (!buffer_.update()) return;
  static_cast<Snapshot&>(frame_) = buffer_.front();  // vectors keep their sizes: no allocation
  complete_(frame_);
  unwritten_ = true;
  if (show_) show_(frame_);
}

/// Also writes it, or the frame that was only shown while the file's viewer slept.
void FramePublisher::write_newest(const GiveUp& give_up) {
  if (!open() && !show_) return;
  complete_newest();
  if (!open() || !unwritten_) return;
  unwritten_ = false;
  if (write(encoder_.encode(frame_, scene_.state_size), give_up)) ++counts_.written;
}

}  // namespace hapgrid
