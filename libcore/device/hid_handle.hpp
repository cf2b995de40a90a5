// One open handle of hidapi. A handle belongs to one thread at a time: hidapi keeps the text of the
// last error in it without a lock, so two threads open the path twice.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libcore/device/hid_protocol.hpp"

struct hid_device_;  // hidapi's

namespace hapgrid {

/// No report is longer, with its id; also the largest that hidapi is asked for.
inline constexpr std::size_t kMaxHidReport = 4096 + 1;

class HidHandle : public HidChannel {
 public:
  /// @throw DeviceError "PATH: why", with what helps against it (open_failure in hid_bus.hpp).
  explicit HidHandle(const std::string& path);
  ~HidHandle() override;
  HidHandle(const HidHandle&) = delete;
  HidHandle& operator=(const HidHandle&) = delete;

  /// Waits at most `milliseconds` for an input report: its size, 0 when none came, -1 when the
  /// device is lost. The time-out is the kernel's to keep.
  int read(std::span<std::uint8_t> buffer, int milliseconds) noexcept;
  /// Whether the device took all of an output report. The kernel waits up to 5 s for that.
  bool try_write(std::span<const std::uint8_t> report) noexcept;
  /// Why the last call did not do what it should, in one line.
  std::string error() const;

  void write(std::span<const std::uint8_t> report) override;
  void set_feature(std::span<const std::uint8_t> report) override;
  HidReport get_feature(std::uint8_t id, std::size_t size) override;

 private:
  std::string path_;
  hid_device_* device_;
  int short_write_ = -1;  // what the last write took, when it was not all
};

}  // namespace hapgrid
