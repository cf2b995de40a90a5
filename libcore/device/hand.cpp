#include "libcore/device/hand.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/signals.hpp"
#include "libcore/device/path.hpp"

namespace hapgrid {

namespace {

constexpr int kAskMs = 50;             // how soon the listener sees that it shall stop
constexpr std::size_t kMaxLine = 256;  // bytes

}  // namespace

std::optional<Vec3> HandLines::read(std::string_view bytes) {
  std::optional<Vec3> newest;
  for (const char c : bytes) {
    if (c == '\n') {
      if (const auto x = read_line()) newest = x;
      continue;
    }
    if (line_.size() == kMaxLine)
      throw Error(format("line {}: longer than {} bytes", number_, kMaxLine));
    line_ += c;
  }
  return newest;
}

std::optional<Vec3> HandLines::finish() { return read_line(); }

std::optional<Vec3> HandLines::read_line() {
  try {
    const bool next = line_ == kHandNext;
    nexts_ += next;
    std::optional<Vec3> x;
    if (const auto tick = next ? std::nullopt : parse_tick(line_)) x = tick->x;
    line_.clear();
    ++number_;
    return x;
  } catch (const Error& e) {
    throw Error(format("line {}: {}", number_, e.what()));
  }
}

HandDevice::HandDevice(const std::string& pipe, const HipRange& range)
    : name_(pipe),
      // Without waiting for a writer: that is the viewer, which waits for the scene.
      pipe_(::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)),
      hand_(range.start),
      hip_(range) {
  if (!pipe_) throw std::system_error(errno, std::generic_category(), pipe);
  const BlockedSignals blocked;
  listener_ = std::jthread([this](const std::stop_token& token) { listen(token); });
}

void HandDevice::listen(const std::stop_token& token) {
  try {
    HandLines lines;
    while (!token.stop_requested())
      if (!listen_once(lines)) {
        status_.store(DeviceStatus::kEnd, std::memory_order_release);
        return;
      }
  } catch (const std::exception& e) {
    error_ = e.what();
    status_.store(DeviceStatus::kFailed, std::memory_order_release);
  }
}

bool HandDevice::listen_once(HandLines& lines) {
  // Before the first writer this waits; without one after that it says POLLHUP.
  pollfd waiting{pipe_.get(), POLLIN, 0};
  if (::poll(&waiting, 1, kAskMs) <= 0) return true;
  char bytes[4096];
  const ssize_t count = ::read(pipe_.get(), bytes, sizeof bytes);
  if (count < 0) {
    if (errno == EAGAIN || errno == EINTR) return true;
    throw std::system_error(errno, std::generic_category());
  }
  const auto x = count > 0 ? lines.read({bytes, static_cast<std::size_t>(count)}) : lines.finish();
  nexts_.store(lines.nexts(), std::memory_order_relaxed);
  if (x) {
    hand_.back() = *x;
    hand_.publish();
  }
  return count > 0;
}

DeviceStatus HandDevice::read(DeviceInput& input) noexcept {
  const DeviceStatus status = status_.load(std::memory_order_acquire);
  if (status != DeviceStatus::kOk) return status;
  const auto now = std::chrono::steady_clock::now();
  const double dt = std::chrono::duration<double>(now - last_.value_or(now)).count();
  last_ = now;
  hand_.update();
  const unsigned nexts = nexts_.load(std::memory_order_relaxed);
  input = {.position = hip_.next(hand_.front(), force_, dt),
           .hand = hand_.front(),
           .next = nexts != std::exchange(seen_nexts_, nexts)};
  return DeviceStatus::kOk;
}

DeviceStatus HandDevice::send(const Vec3& force) noexcept {
  force_ = force;
  return DeviceStatus::kOk;
}

}  // namespace hapgrid
