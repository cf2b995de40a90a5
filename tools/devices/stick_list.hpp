// Lists the event devices that have a stick, and finds the one that the user means.
#pragma once

#include <string>
#include <vector>

#include "tools/devices/hid_bus.hpp"

namespace hapgrid {

/// An event device with a stick, at "/dev/input/event7"; its name is the product.
struct EvdevInfo : HidInfo {
  bool constant = false, rumble = false;  ///< the effects that it has
};

/// All wheels, sticks and gamepads in the order of their numbers, from sysfs, which also lists
/// those that the user may not open. A device with force needs one axis; a device without force
/// needs two, and a button of a joystick or gamepad. Motion sensors and touch pads are left out.
std::vector<EvdevInfo> list_evdev(const std::string& sysfs = "/sys/class/input");

/// The one device that matches; when the user names none, the one with the most effects.
/// @throw DeviceError "no gamepad or stick is ...", or "2 gamepads or sticks are ...".
EvdevInfo find_one_evdev(const std::vector<EvdevInfo>& devices, const HidMatch& match);

/// The udev rule for a device that the user may not open, and how to install it.
std::string stick_permission(const EvdevInfo& info);

/// One line for a path that could not be opened; see open_failure().
std::string evdev_open_failure(const std::string& path, int error);

}  // namespace hapgrid
