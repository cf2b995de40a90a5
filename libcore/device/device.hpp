// What every device is to the haptic loop, be it hardware, a scripted path or a replay.
#pragma once

#include <string>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// The outcome of one call to a device.
enum class DeviceStatus {
  kOk,
  kEnd,     ///< read() only: there is nothing more to come, in good order
  kFailed,  ///< the device is lost; error() says why
};

/// Opened by its constructor, closed by its destructor. Used by one thread at a time; read() and
/// send() are real-time safe: no allocation, lock or exception, and no waiting for the hardware
/// longer than the device's own documentation allows for.
///
/// A device sends what it is given. Limits, and the zero force at every way out, are the duty of
/// the haptic loop: a destructor cannot tell anybody that it failed.
class Device {
 public:
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// The newest HIP position, in the model's unit of length; `hip` is only written with kOk.
  virtual DeviceStatus read(Vec3& hip) noexcept = 0;
  /// Applies a force, in newtons.
  virtual DeviceStatus send(const Vec3& force) noexcept = 0;
  /// What went wrong last, in words. Not real-time safe.
  virtual std::string error() const = 0;

 protected:
  Device() = default;
};

}  // namespace hapgrid
