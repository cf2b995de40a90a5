// The keyboard of a terminal as a device without force: its keys move the HIP, also over ssh.
#pragma once

#include <termios.h>

#include <array>
#include <atomic>
#include <chrono>
#include <optional>
#include <string>
#include <thread>

#include "libcore/base/file.hpp"
#include "libcore/device/device.hpp"

namespace hapgrid {

/// Understands the bytes that a terminal sends for keys.
class KeyReader {
 public:
  /// @param box that the HIP does not leave. @param start where it begins, and key 0 moves it
  /// @param step how far a key moves it, in the model's unit
  KeyReader(const Box& box, const Vec3& start, double step);
  /// Reads one byte; a key may send several.
  void read(unsigned char byte);
  const Vec3& target() const { return target_; }
  bool quit() const { return quit_; }
  unsigned resets() const { return resets_; }
  unsigned nexts() const { return nexts_; }

 private:
  void obey(unsigned char final_byte, int parameter);
  void move(int axis, double steps);

  Box box_;
  Vec3 start_, target_;
  double first_step_;
  double step_;
  bool quit_ = false;
  unsigned resets_ = 0;
  unsigned nexts_ = 0;
  enum class Expect { kKey, kAfterEscape, kSequence, kModifiers } expect_ = Expect::kKey;
  int parameter_ = 0;
};

/// While it lives the terminal neither collects lines nor echoes; Ctrl-C still interrupts.
class KeyboardDevice : public Device {
 public:
  /// @throw DeviceError when the process has no terminal; std::system_error
  KeyboardDevice(const Box& box, const Vec3& start, double step);
  ~KeyboardDevice() override;

  DeviceInfo info() const override { return {.name = "keys"}; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3&) noexcept override { return DeviceStatus::kOk; }
  /// Restores the terminal.
  DeviceStatus stop() noexcept override;
  std::string error() const override { return "the terminal is gone"; }

 private:
  void listen(const std::stop_token& token);

  FileDescriptor terminal_;
  termios before_{};
  KeyReader keys_;  // the listener's
  std::array<std::atomic<double>, 3> target_;
  std::atomic<unsigned> resets_{0}, nexts_{0};
  std::atomic<bool> quit_{false};
  std::atomic<bool> lost_{false};
  std::atomic<bool> restored_{false};  // the terminal
  // The haptic thread's.
  Vec3 position_;
  std::optional<std::chrono::steady_clock::time_point> last_;
  unsigned seen_resets_ = 0, seen_nexts_ = 0;
  std::jthread listener_;
};

}  // namespace hapgrid
