// Which device the command line names, and opening it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "libcore/device/device.hpp"
#include "libcore/device/process_device.hpp"
#include "libcore/session/recording.hpp"
#include "tools/play/settings.hpp"

namespace hapgrid {

// What --device can name.
struct PathFile {
  std::string file;  ///< "-": standard input
};
struct ReplayFile {
  std::string file;
};
struct TerminalKeys {};
/// Hardware, which an adapter drives. `kind` is "hid", "spacemouse" or "evdev", whose adapters lie
/// beside this program, or "process"; `argument` is what stands behind it.
struct AdapterChoice {
  std::string kind, argument;
};
using DeviceChoice = std::variant<PathFile, ReplayFile, TerminalKeys, AdapterChoice>;

/// Opens nothing. @throw UsageError for what is not a device's name
DeviceChoice parse_device(const std::string& name);

/// The file that tells what the hand does, "-" for standard input; empty for other devices.
std::string input_file(const DeviceChoice& device);
/// What its keys do, in a line for a viewer's screen; empty for a device that reads no keys.
std::string keys_of(const DeviceChoice& device);
/// Whether a person moves the device, for as long as they like.
bool is_live(const DeviceChoice& device);

/// How the adapter is started. @param rate_hz forces a second that were asked for; 0: none
AdapterProgram adapter_program(const AdapterChoice& choice, const PlaySettings& settings,
                               double rate_hz);

/// A device that is open, and what play has to know about it.
struct OpenDevice {
  std::unique_ptr<Device> device;
  std::size_t ticks = ~std::size_t{0};     ///< how many a path or a replay has
  std::optional<SessionHeader> session;    ///< of a replay
  const ProcessDevice* adapter = nullptr;  ///< `device`, if it is one
};

/// @param rate_hz see adapter_program(). @param box of the grid.
/// @throw DeviceError, Error, std::system_error
OpenDevice open_device(const DeviceChoice& device, const PlaySettings& settings, double rate_hz,
                       const Box& box);

/// Prints what --list-devices asks for.
void print_devices();

}  // namespace hapgrid
