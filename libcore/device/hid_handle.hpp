// One open handle of hidapi. A handle belongs to one thread at a time: hidapi keeps the text of the
// last error in it without a lock, so two threads open the path twice.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libcore/device/hid_protocol.hpp"

struct hid_device_;  // hidapi's

namespace hapgrid {

/// The longest report, with its id.
inline constexpr std::size_t kMaxHidReport = 4096 + 1;

class HidHandle : public HidChannel {
 public:
  /// @throw DeviceError "PATH: why", and what helps (open_failure() in hid_bus.hpp).
  explicit HidHandle(const std::string& path);
  ~HidHandle() override;
  HidHandle(const HidHandle&) = delete;
  HidHandle& operator=(const HidHandle&) = delete;

  /// Waits at most `milliseconds` for an input report.
  /// @return its size; 0 when none came; -1 when the device is lost
  int read(std::span<std::uint8_t> buffer, int milliseconds) noexcept;
  /// Writes an output report; the kernel waits up to 5 s. @return whether the device took all of it
  bool try_write(std::span<const std::uint8_t> report) noexcept;
  /// Why the last call failed, in one line.
  std::string error() const;

  void write(std::span<const std::uint8_t> report) override;
  void set_feature(std::span<const std::uint8_t> report) override;
  HidReport get_feature(std::uint8_t id, std::size_t size) override;

 private:
  std::string path_;
  hid_device_* device_;
  int short_write_ = -1;  // bytes that the last write took, when it did not take all
};

}  // namespace hapgrid
