#include "tools/play/publisher.hpp"

#include <limits.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "libcore/base/signals.hpp"

namespace hapgrid {

namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::nanoseconds kPeriod{1'000'000'000 / kLiveFramesPerSecond};
constexpr std::chrono::seconds kLinger{1};
constexpr int kAskEveryMs = 20;

Frame empty_frame(std::size_t row_size, std::size_t spheres) {
  Frame frame;
  frame.row.resize(row_size);
  frame.centres.resize(3 * spheres);
  return frame;
}

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
      buffer_(empty_frame(row_size, scene.spheres.size())) {
  // A pipe that poll() calls writable takes PIPE_BUF bytes. O_NONBLOCK would work for any number,
  // but it belongs to the pipe: other writers would see it too.
  struct stat status {};
  const bool regular = ::fstat(output_.fd(), &status) == 0 && S_ISREG(status.st_mode);
  piece_ = regular ? std::numeric_limits<std::size_t>::max() : PIPE_BUF;
  frame_ = buffer_.front();
  encoder_.encode(frame_, scene_.state_size);  // takes the memory for all of them
  if (!paced_) {
    write(encoder_.encode(scene_), stopped_);
    return;
  }
  std::packaged_task<void(std::stop_token)> task([this](const std::stop_token& t) { run(t); });
  ended_ = task.get_future();
  const BlockedSignals blocked;
  slow_ = std::jthread(std::move(task));
}

void FramePublisher::publish() {
  if (paced_) {
    buffer_.publish();
    return;
  }
  left_ = buffer_.back().tick < due_;
  if (left_) return;
  due_ = (buffer_.back().tick / ticks_per_frame_ + 1) * ticks_per_frame_;
  buffer_.publish();
  std::unique_lock lock(mutex_);
  write_newest(stopped_, lock);
}

FrameCounts FramePublisher::finish() {
  if (paced_) {
    slow_.request_stop();
    if (ended_.wait_for(kLinger) != std::future_status::ready) {
      const std::lock_guard lock(mutex_);  // it still writes, or it is in complete_
      counts_.lacking = open();
    }
    if (counts_.lacking) {
      slow_.detach();
    } else {
      slow_.join();
      ended_.get();
    }
  } else if (left_) {
    buffer_.publish();
    std::unique_lock lock(mutex_);
    write_newest(stopped_, lock);
  }
  output_.commit();
  return counts_;
}

/// The slow thread.
void FramePublisher::run(const std::stop_token& token) {
  const auto start = SteadyClock::now();
  std::optional<SteadyClock::time_point> patience;
  const GiveUp give_up = [&] {
    if (!token.stop_requested()) return false;
    if (!patience) patience = SteadyClock::now() + kLinger;
    return SteadyClock::now() >= *patience;
  };
  std::unique_lock lock(mutex_);
  write(encoder_.encode(scene_), give_up);
  for (std::uint64_t due = 0;;) {
    const bool last = token.stop_requested();  // asked first: then nothing newer can come
    const bool was_open = open();
    write_newest(give_up, lock);
    const auto late = static_cast<std::uint64_t>((SteadyClock::now() - start) / kPeriod);
    if (was_open && late > due) counts_.dropped += late - due;
    if (last || !open()) return;
    due = std::max(due, late) + 1;
    lock.unlock();
    std::this_thread::sleep_until(start + due * kPeriod);
    lock.lock();
  }
}

bool FramePublisher::write(std::span<const std::byte> message, const GiveUp& give_up) {
  const NoSigpipe
      no_sigpipe;  // a closed pipe is an outcome here, whatever the process does with it
  const auto fail = [&] {
    throw std::system_error(errno, std::generic_category(), output_.name());
  };
  while (!message.empty()) {
    pollfd viewer{output_.fd(), POLLOUT, 0};
    const int ready = ::poll(&viewer, 1, kAskEveryMs);
    if (ready < 0 && errno != EINTR) fail();
    if (ready <= 0) {
      counts_.cut = give_up();
      if (counts_.cut) return false;
      continue;
    }
    const ssize_t count = ::write(output_.fd(), message.data(), std::min(message.size(), piece_));
    if (count < 0 && errno == EPIPE) {
      counts_.closed = true;
      return false;
    }
    if (count < 0 && errno != EINTR && errno != EAGAIN) fail();
    if (count > 0) message = message.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

/// Completes and writes the newest frame, if there is a new one.
void FramePublisher::write_newest(const GiveUp& give_up, std::unique_lock<std::mutex>& lock) {
  if (!open() || !buffer_.update()) return;
  frame_ = buffer_.front();  // vectors keep their sizes: no allocation
  lock.unlock();
  complete_(frame_);
  lock.lock();
  if (open() && write(encoder_.encode(frame_, scene_.state_size), give_up)) ++counts_.written;
}

}  // namespace hapgrid
