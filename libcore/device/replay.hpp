// A device that repeats what a hand did, tick by tick.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libcore/device/device.hpp"

namespace hapgrid {

/// What a device reported at one tick of a recorded play.
struct ReplayTick {
  DeviceInput input;         ///< without `missed`
  std::uint64_t missed = 0;  ///< ticks that were missed before this one
};

/// Each read() gives the next tick, and in DeviceInput::missed the ticks that were missed before
/// it, so that the loop does what it did then.
class ReplayDevice : public Device {
 public:
  explicit ReplayDevice(std::vector<ReplayTick> ticks) : ticks_(std::move(ticks)) {}

  std::size_t size() const { return ticks_.size(); }
  /// The force that was sent last.
  const Vec3& force() const { return force_; }

  DeviceInfo info() const override { return {.name = "replay"}; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override { return send({0, 0, 0}); }
  std::string error() const override { return "a replay does not fail"; }

 private:
  std::vector<ReplayTick> ticks_;
  std::size_t next_ = 0;
  Vec3 force_{0, 0, 0};
};

}  // namespace hapgrid
