// What every device is to the haptic loop, be it hardware, a keyboard, a scripted path or a replay.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// The outcome of one call to a device.
enum class DeviceStatus {
  kOk,
  kEnd,     ///< read() only: there is nothing more to come, in good order
  kFailed,  ///< the device is lost; error() says why
};

/// What the hand does, as the device knows it at a tick.
struct DeviceInput {
  Vec3 position{0, 0, 0};  ///< of the handle, in the device's unit (DeviceInfo)
  /// Of a HIP that is steered, not held: how fast, each axis in [-1, 1] of full deflection. The
  /// loop adds it up over time; 0 for a handle that is held.
  Vec3 rate{0, 0, 0};
  bool stalled = false;  ///< the hardware was silent for longer than it should be
  bool clutch = false;   ///< the handle is moved without the HIP
  /// The user wants the force back after a fault. A button may be held: the loop takes its press
  /// alone, so that no fault ends that the user has not felt.
  bool reset = false;
  /// Only in a replay: ticks that were missed before this one when it was recorded.
  std::uint64_t missed = 0;
};

/// What does not change while a device is open.
struct DeviceInfo {
  /// What DeviceInput::position is in, and so whether it has to be mapped to the box.
  enum class Unit {
    kModel,   ///< the model's unit of length, in the box's axes: nothing to map
    kMetres,  ///< metres: x to the right, y away from the user, z up
    kRate,    ///< there is no position: DeviceInput::rate, in the same axes, steers the HIP
  };
  std::string name;  ///< for people: "Teensy RawHID (16c0:0486)"
  Unit unit = Unit::kModel;
  /// Metres: what the handle can reach. low = high on an axis that the device does not have.
  Vec3 low{0, 0, 0};
  Vec3 high{0, 0, 0};
  /// Newtons that the device can hold for long, of the magnitude.
  double max_force = std::numeric_limits<double>::infinity();
  bool has_force = false;  ///< false: what is sent is felt by nobody
};

/// Opened by its constructor, closed by its destructor. read() and send() are the haptic thread's
/// and real-time safe: no allocation, lock or exception, and no waiting for the hardware.
///
/// A device sends what it is given. Limits, and the zero force at every way out, are the duty of
/// the haptic loop: a destructor cannot tell anybody that it failed. What a device does on its own
/// is to let go when the loop no longer tells it anything (see HidDevice).
class Device {
 public:
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  virtual DeviceInfo info() const = 0;
  /// The newest position; `input` is only written with kOk.
  virtual DeviceStatus read(DeviceInput& input) noexcept = 0;
  /// Applies a force, in newtons, in the axes of DeviceInput::position.
  virtual DeviceStatus send(const Vec3& force) noexcept = 0;
  /// The last call: sends zero force, and waits, a second at most, until the hardware has it. kOk
  /// says that it has. Not real-time safe; later calls do nothing and answer the same.
  virtual DeviceStatus stop() noexcept = 0;
  /// What went wrong first, in words. Not real-time safe.
  virtual std::string error() const = 0;

 protected:
  Device() = default;
};

}  // namespace hapgrid
