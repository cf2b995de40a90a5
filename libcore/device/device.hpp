// The interface of a device to the haptic loop, for hardware, a keyboard, a path, a replay and a
// simulation.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

/// The outcome of one call to a device.
enum class DeviceStatus {
  kOk,
  kEnd,     ///< of read() only: the path or replay is over, or the user wants to end
  kFailed,  ///< the device is lost; error() says why
};

/// The input of one tick: what the hand does.
struct DeviceInput {
  Vec3 position{0, 0, 0};  ///< of the handle, in the device's unit (DeviceInfo)
  /// For a device that steers the HIP: its speed on each axis, in [-1, 1] of full deflection. The
  /// mapping adds it up over time. 0 for a handle that is held.
  Vec3 rate{0, 0, 0};
  /// Position of the hand, if the handle or the HIP hangs on it by a spring, in the same unit; else
  /// NaN.
  Vec3 hand = kNowhere;
  bool stalled = false;  ///< the hardware has been silent for too long
  bool clutch = false;   ///< the handle is moved without the HIP
  /// The user wants the force back after a fault. The loop acts when the button is pressed, not
  /// while it is held, so that no fault ends before the user has felt it.
  bool reset = false;
  /// The user wants another state at this place: that of the grid's next level. The press counts.
  bool next = false;
  /// Another hand begins here, or the hand was put elsewhere: no tick before counts.
  bool begins = false;
  /// Only in a replay: how many ticks were missed before this one when it was recorded.
  std::uint64_t missed = 0;
  /// Only in a replay: nanoseconds for which the slew limit let the force change when it was
  /// recorded; 0: for the periods of the schedule.
  std::int64_t slew_ns = 0;
};

/// The properties of a device, which do not change while it is open.
struct DeviceInfo {
  /// The kind of input that the device reports, which decides how it is mapped to the box.
  enum class Unit {
    kModel,   ///< positions in the model's unit of length and the box's axes: nothing to map
    kMetres,  ///< positions in metres: x to the right, y away from the user, z up
    kRate,    ///< no positions: DeviceInput::rate, in the same axes, steers the HIP
  };
  std::string name;  ///< for people: "Teensy RawHID (16c0:0486)"
  Unit unit = Unit::kModel;
  /// The range of the handle, in metres. low = high on an axis that the device does not have.
  Vec3 low{0, 0, 0};
  Vec3 high{0, 0, 0};
  /// The largest magnitude of a force that the device can hold for long, in newtons.
  double max_force = std::numeric_limits<double>::infinity();
};

/// A constructor opens the device, the destructor closes it. The haptic thread calls read(),
/// snap() and send(), which are real-time safe: they do not allocate, lock, throw, or wait for the
/// hardware (only ProcessDevice waits, for an adapter that is late).
///
/// A device sends every force that it is given. The haptic loop limits forces, and sends a zero
/// force on every way out, because a destructor cannot report that it failed. An adapter takes the
/// force away when it no longer hears from the loop (let_go.hpp).
class Device {
 public:
  virtual ~Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  virtual DeviceInfo info() const = 0;
  /// The newest input. `input` is written only with kOk.
  virtual DeviceStatus read(DeviceInput& input) noexcept = 0;
  /// Applies a force, in newtons, in the axes of DeviceInput::position.
  virtual DeviceStatus send(const Vec3& force) noexcept = 0;
  /// The state jumped to another branch, to which the next force belongs. A device that cannot show
  /// a force as such (a rumble) shows the jump by itself.
  virtual void snap() noexcept {}
  /// The last call: sends zero force, and waits until the hardware took it, which kOk says, or will
  /// not. Not real-time safe. Later calls do nothing and return the same.
  virtual DeviceStatus stop() noexcept = 0;
  /// Gives the device's process, through which forces pass, this priority under SCHED_FIFO, so that
  /// they do not wait; 0 takes it back. Not real-time safe.
  /// @return whether all of them took it
  virtual bool set_priority(int) noexcept { return true; }
  /// Binds the device's process to this processor, where the caller will stay: a force then reaches
  /// it without another processor being woken up. Not real-time safe. @return whether it is bound
  virtual bool share_processor(int) noexcept { return false; }
  /// The first failure, in words. Not real-time safe.
  virtual std::string error() const = 0;

 protected:
  Device() = default;
};

}  // namespace hapgrid
