// Which device the command line names, and opening it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "libcore/device/device.hpp"
#include "libcore/device/hid_guard.hpp"
#include "libcore/session/recording.hpp"
#include "tools/play/options.hpp"

namespace hapgrid {

inline constexpr const char* kDeviceForms =
    "path:FILE moves the HIP through the positions in FILE ('path:-': standard input); keys is the "
    "terminal's keyboard; replay:FILE does what was done in a log; profile:FILE is a HID device "
    "that a text describes (examples/devices); pid or pid:WHICH a joystick of the PID class; "
    "spacemouse or spacemouse:WHICH steers the HIP. WHICH is a path, VID:PID, VID:PID:SERIAL or a "
    "serial number of --list-devices";

/// What is wrong with a device's name; empty when nothing is. Opens nothing.
std::string device_mistake(const std::string& name);

/// The file that a path or a replay reads, "-" for standard input; else empty.
std::string device_file(const std::string& name);
/// Whether a hand moves it, as long as it likes.
bool is_live(const std::string& name);
/// Whether there is a force on a hand, which must end with this program.
bool needs_guard(const std::string& name);

/// A device that is open, and what play has to know of it.
struct OpenDevice {
  std::unique_ptr<Device> device;
  bool live = true;                      ///< a hand: it needs a pace
  std::size_t ticks = 0;                 ///< how many it has, where it is not live
  std::optional<SessionHeader> session;  ///< of a replay
};

/// @param box of the grid. @param guard of a device that needs one.
/// @throw DeviceError, Error, std::system_error
OpenDevice open_device(const PlayOptions& options, const Box& box, HidGuard* guard);

/// Prints what --list-devices and --dump-descriptor ask for. @throw DeviceError
void print_devices();
void print_descriptor(const std::string& which);

}  // namespace hapgrid
