// One open handle of hidapi, and the reports of a HID device.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

struct hid_device_;  // hidapi's

namespace hapgrid {

/// A report as hidapi writes it: the id first, 0 for a device without ids.
using HidReport = std::vector<std::uint8_t>;
/// The longest report, with its id.
inline constexpr std::size_t kMaxHidReport = 4096 + 1;

class HidHandle {
 public:
  /// @throw DeviceError "PATH: why", and what helps (open_failure() in hid_bus.hpp).
  explicit HidHandle(const std::string& path);
  ~HidHandle();
  HidHandle(const HidHandle&) = delete;
  HidHandle& operator=(const HidHandle&) = delete;

  /// Gives all input reports that have come to `use`, at most as many as the kernel queues, so that
  /// a flood of them does not hold the caller. @throw DeviceError when the device is lost
  void drain(const std::function<void(std::span<const std::uint8_t>)>& use);
  /// Writes an output report. The kernel may wait up to 5 s for the device. @throw DeviceError when
  /// it did not take all of it.
  void write(std::span<const std::uint8_t> report);
  /// Writes a feature report. @throw DeviceError
  void set_feature(std::span<const std::uint8_t> report);

 private:
  std::string path_;
  hid_device_* device_;
  HidReport buffer_;
};

/// Writes all reports, also after one that the device did not take. @throw DeviceError for the
/// first one
void write_all(HidHandle& handle, const std::vector<HidReport>& reports);

}  // namespace hapgrid
