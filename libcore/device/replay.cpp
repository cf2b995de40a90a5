#include "libcore/device/replay.hpp"

namespace hapgrid {

DeviceStatus ReplayDevice::read(DeviceInput& input) noexcept {
  if (next_ == ticks_.size()) return DeviceStatus::kEnd;
  input = ticks_[next_++];
  return DeviceStatus::kOk;
}

DeviceStatus ReplayDevice::send(const Vec3& force) noexcept {
  force_ = force;
  return DeviceStatus::kOk;
}

}  // namespace hapgrid
