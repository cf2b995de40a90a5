// One open handle of hidapi. A handle belongs to one thread at a time: hidapi keeps the text of the
// last error in it without a lock, so two threads open the path twice.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "libcore/device/hid_protocol.hpp"

struct hid_device_;  // hidapi's

namespace hapgrid {

/// The longest report, with its id.
inline constexpr std::size_t kMaxHidReport = 4096 + 1;

class HidHandle : public HidWire {
 public:
  /// @throw DeviceError "PATH: why", and what helps (open_failure() in hid_bus.hpp).
  explicit HidHandle(const std::string& path);
  ~HidHandle() override;

  int read(std::span<std::uint8_t> buffer, int milliseconds) noexcept override;
  /// The kernel waits up to 5 s.
  bool try_write(std::span<const std::uint8_t> report) noexcept override;
  std::string error() const override;

  void write(std::span<const std::uint8_t> report) override;
  void set_feature(std::span<const std::uint8_t> report) override;

 private:
  std::string path_;
  hid_device_* device_;
  int short_write_ = -1;  // bytes that the last write took, when it did not take all
};

/// A handle of hidapi, or, where the path is an event device's, an EvdevHandle. @throw DeviceError
std::unique_ptr<HidWire> open_wire(const std::string& path);

}  // namespace hapgrid
