#include "libcore/device/keyboard.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/signals.hpp"

namespace hapgrid {

namespace {

constexpr unsigned char kEscape = 0x1b;
constexpr double kStepFactor = 1.5;
constexpr int kPollMs = 50;
// Time constant with which the HIP follows a key's step: a jump would feel like a blow.
constexpr double kFollowSeconds = 0.05;

FileDescriptor open_terminal() {
  FileDescriptor terminal(::open("/dev/tty", O_RDWR | O_CLOEXEC | O_NOCTTY));
  if (!terminal) throw DeviceError("keys: there is no terminal to read (with ssh use -t)");
  return terminal;
}

}  // namespace

KeyReader::KeyReader(const Box& box, const Vec3& start, double step)
    : box_(box), start_(start), target_(start), first_step_(step), step_(step) {}

void KeyReader::move(int axis, double steps) {
  target_[axis] = std::clamp(target_[axis] + steps * step_, box_.origin[axis], box_.high()[axis]);
}

void KeyReader::obey(unsigned char final_byte, int parameter) {
  switch (final_byte) {
    case 'A':
      return move(2, 1);
    case 'B':
      return move(2, -1);
    case 'C':
      return move(0, 1);
    case 'D':
      return move(0, -1);
    case '~':
      if (parameter == 5) move(1, 1);
      if (parameter == 6) move(1, -1);
      return;
    default:
      return;
  }
}

void KeyReader::read(unsigned char byte) {
  switch (expect_) {
    case Expect::kAfterEscape:
      // ESC [ or, with application cursor keys, ESC O. Any other byte is a key after a lone escape.
      if (byte == '[' || byte == 'O') {
        expect_ = Expect::kSequence;
        parameter_ = 0;
        return;
      }
      expect_ = Expect::kKey;
      break;
    case Expect::kSequence:
      if (byte >= '0' && byte <= '9') {
        if (parameter_ < 100) parameter_ = 10 * parameter_ + (byte - '0');
        return;
      }
      if (byte == ';') {
        expect_ = Expect::kModifiers;
        return;
      }
      expect_ = Expect::kKey;
      return obey(byte, parameter_);
    case Expect::kModifiers:  // which do not count
      if ((byte >= '0' && byte <= '9') || byte == ';') return;
      expect_ = Expect::kKey;
      return obey(byte, parameter_);
    case Expect::kKey:
      break;
  }
  switch (byte) {
    case kEscape:
      expect_ = Expect::kAfterEscape;
      return;
    case 'q':
      quit_ = true;
      return;
    case 'r':
      ++resets_;
      return;
    case 'n':
      ++nexts_;
      return;
    case '0':
      target_ = start_;
      return;
    case '+':
    case '=':
      step_ = std::min(step_ * kStepFactor, box_.longest_side() / 4);
      return;
    case '-':
      step_ = std::max(step_ / kStepFactor, first_step_ / 1000);
      return;
    default:
      return;
  }
}

KeyboardDevice::KeyboardDevice(const Box& box, const Vec3& start, double step)
    : terminal_(open_terminal()), keys_(box, start, step), position_(start) {
  if (::tcgetattr(terminal_.get(), &before_) != 0)
    throw std::system_error(errno, std::generic_category(), "/dev/tty");
  termios mode = before_;
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  mode.c_cc[VMIN] = 0;
  mode.c_cc[VTIME] = 0;
  if (::tcsetattr(terminal_.get(), TCSANOW, &mode) != 0)
    throw std::system_error(errno, std::generic_category(), "/dev/tty");
  for (int a = 0; a < 3; ++a) target_[a] = start[a];
  const BlockedSignals blocked;
  listener_ = std::jthread([this](const std::stop_token& token) { listen(token); });
}

KeyboardDevice::~KeyboardDevice() { stop(); }

DeviceStatus KeyboardDevice::stop() noexcept {
  if (!restored_.exchange(true)) ::tcsetattr(terminal_.get(), TCSANOW, &before_);
  return DeviceStatus::kOk;
}

void KeyboardDevice::listen(const std::stop_token& token) {
  while (!token.stop_requested()) {
    pollfd waiting{terminal_.get(), POLLIN, 0};
    const int ready = ::poll(&waiting, 1, kPollMs);
    if (ready <= 0) continue;
    unsigned char bytes[64];
    const ssize_t count = ::read(terminal_.get(), bytes, sizeof bytes);
    if (count <= 0 && (waiting.revents & (POLLHUP | POLLERR))) {
      lost_ = true;
      return;
    }
    for (ssize_t i = 0; i < count; ++i) keys_.read(bytes[i]);
    for (int a = 0; a < 3; ++a) target_[a].store(keys_.target()[a], std::memory_order_relaxed);
    resets_.store(keys_.resets(), std::memory_order_relaxed);
    nexts_.store(keys_.nexts(), std::memory_order_relaxed);
    quit_.store(keys_.quit(), std::memory_order_relaxed);
  }
}

DeviceStatus KeyboardDevice::read(DeviceInput& input) noexcept {
  if (lost_.load(std::memory_order_relaxed)) return DeviceStatus::kFailed;
  if (quit_.load(std::memory_order_relaxed)) return DeviceStatus::kEnd;
  const auto now = std::chrono::steady_clock::now();
  const double dt = std::chrono::duration<double>(now - last_.value_or(now)).count();
  last_ = now;
  const double part = dt / (kFollowSeconds + dt);
  for (int a = 0; a < 3; ++a)
    position_[a] += part * (target_[a].load(std::memory_order_relaxed) - position_[a]);
  const unsigned resets = resets_.load(std::memory_order_relaxed);
  const unsigned nexts = nexts_.load(std::memory_order_relaxed);
  input = {.position = position_, .reset = resets != seen_resets_, .next = nexts != seen_nexts_};
  seen_resets_ = resets;
  seen_nexts_ = nexts;
  return DeviceStatus::kOk;
}

}  // namespace hapgrid
