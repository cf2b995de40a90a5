// Gamepads and force-feedback sticks as the kernel's drivers show them: event devices with axes,
// buttons and effects (Documentation/input/gamepad.rst and ff.rst; linux/input.h).
//
// Problem. Each maker's stick has its own reports and its own way to be given a force; the kernel
// has drivers for nearly all of them, the PID class among them. Choice: axes in, one effect out,
// whose values change while it plays.
//
// | the device                 | the hand                                | the force              |
// |----------------------------|-----------------------------------------|------------------------|
// | has the effect FF_CONSTANT | holds it: an axis' place is a position  | a constant force       |
// | has FF_RUMBLE, or none     | steers: an axis' deflection is a speed  | the strong motor; the  |
// |                            |                                         | weak one says a snap   |
//
// Effects last kEvdevEffect and are started anew five times in that time, so the kernel or the
// device ends them when nobody does.
//
// Alternatives: two constant forces, along x and along y (an update in two steps can be stronger
// than both its ends; one in level and direction cannot), reports of the PID class written by
// ourselves (only that class, and a second reader of report descriptors beside the kernel's).
#pragma once

#include <linux/input.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "libcore/device/process_protocol.h"
#include "libcore/grid/box.hpp"

namespace hapgrid {

/// An absolute axis (struct input_absinfo).
struct EvdevAxis {
  std::uint16_t code = 0;  ///< ABS_X, ...
  int low = 0, high = 0;   ///< low < high
  int flat = 0;            ///< so far from the middle is rest

  /// The deflection in [-1, 1] as the kernel's joydev has it: 0 up to `flat` from the middle, full
  /// from `flat` before the end on. A driver that names no `flat` gets the kernel's value for
  /// gamepads: a sixteenth of the range.
  double rate(int value) const noexcept;
  /// The place in [-1, 1] of the range.
  double place(int value) const noexcept;
};

/// Those axes and effects of an event device that hapgrid uses.
struct EvdevLayout {
  std::string name;  ///< for people
  bool constant = false, rumble = false, gain = false, autocenter = false;
  /// To the right; towards the user; and, of the second stick, downwards.
  std::array<std::optional<EvdevAxis>, 3> axes{};
  std::uint16_t second_button = 0;  ///< BTN_THUMB, BTN_EAST, ...; 0: there is none

  bool has_force() const { return constant || rumble; }
};

struct EvdevParameters {
  double half_range = 0.05;  ///< metres from the middle of a held axis to its end; above 0
  double newtons = 2;        ///< of the strongest effect; above 0
  /// Of x and y in a held device: 1, or -1 where it pushes the wrong way; y 0: it has no motor, as
  /// the pedals of a wheel.
  std::array<double, 2> signs{1, 1};
};

inline constexpr std::uint16_t kEvdevEffect = 250;  ///< ms

/// The constant force of at most `newtons` along the plane (x to the right, y away from the user):
/// level and direction are rounded, the level towards zero. A force that is not finite is none.
ff_effect constant_effect(const Vec3& force, const EvdevParameters& parameters) noexcept;
/// The strong motor, as strong as the force, rounded towards zero.
ff_effect rumble_effect(const Vec3& force, const EvdevParameters& parameters) noexcept;
/// The weak motor, for a moment.
ff_effect snap_effect() noexcept;

/// The layout with those axes that have motors where it is held, and checked parameters.
/// @throw Error when a parameter is out of its range; DeviceError without an axis.
EvdevLayout usable_layout(EvdevLayout layout, EvdevParameters& parameters);

hapgrid_device_greeting stick_greeting(const EvdevLayout& layout, const EvdevParameters& parameters,
                                       double rate);

/// Takes the event of an axis or a button; the second button is HAPGRID_DEVICE_NEXT, any
/// other HAPGRID_DEVICE_RESET.
void take_event(const EvdevLayout& layout, const EvdevParameters& parameters,
                const input_event& event, hapgrid_device_state& state) noexcept;

}  // namespace hapgrid
