// One open event device, through libevdev. What is read is events, what is written is EvdevWords.
#pragma once

#include <linux/input.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/device/evdev.hpp"
#include "libcore/device/hid_protocol.hpp"

struct libevdev;

namespace hapgrid {

/// Whether a path is an event device's.
bool is_evdev(const std::string& path);

/// The kernel ties effects to the handle that made them, and erases them when it is closed, however
/// that happens. Any handle may stop them, the guard's too.
class EvdevHandle : public HidWire {
 public:
  /// @throw DeviceError "PATH: why", and what helps.
  explicit EvdevHandle(const std::string& path);
  ~EvdevHandle() override;

  EvdevLayout layout() const;

  /// Reads a struct input_event of an axis or a button: first the present value of each, then the
  /// changes. After an overflow of the kernel's queue, libevdev repeats the changes that were lost.
  int read(std::span<std::uint8_t> buffer, int milliseconds) noexcept override;
  /// Drivers may wait for the device in here.
  bool try_write(std::span<const std::uint8_t> report) noexcept override;
  std::string error() const override;

  void write(std::span<const std::uint8_t> report) override;
  void set_feature(std::span<const std::uint8_t> report) override { write(report); }

 private:
  static constexpr std::size_t kSlots = 2;

  std::optional<input_event> next() noexcept;
  bool change(std::span<const std::uint8_t> report) noexcept;
  bool send(std::span<const input_event> events) noexcept;
  bool stop(int id) noexcept;
  bool silence() noexcept;

  std::string path_;
  FileDescriptor fd_;
  libevdev* device_ = nullptr;
  std::vector<input_event> first_;  // where the axes are, the first one last
  bool syncing_ = false;
  struct Slot {
    std::int16_t id = -1;  // the kernel's; -1: not created yet
    HidReport last;        // that changed it
  };
  std::array<Slot, kSlots> slots_;
  int error_ = 0;  // errno of the last call that failed
};

}  // namespace hapgrid
