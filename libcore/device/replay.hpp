// A device that repeats what a hand did, tick by tick.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libcore/device/device.hpp"

namespace hapgrid {

/// Each read() gives the next input of a recorded play. Its DeviceInput::missed tells the ticks
/// that were missed before it, so that the loop does what it did then.
class ReplayDevice : public Device {
 public:
  explicit ReplayDevice(std::vector<DeviceInput> ticks) : ticks_(std::move(ticks)) {}

  std::size_t size() const { return ticks_.size(); }
  /// The force that was sent last.
  const Vec3& force() const { return force_; }

  DeviceInfo info() const override { return {.name = "replay"}; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override { return send({0, 0, 0}); }
  std::string error() const override { return "a replay does not fail"; }

 private:
  std::vector<DeviceInput> ticks_;
  std::size_t next_ = 0;
  Vec3 force_{0, 0, 0};
};

}  // namespace hapgrid
