// Which device the command line names, and opening it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "libcore/device/device.hpp"
#include "libcore/device/process_device.hpp"
#include "libcore/session/recording.hpp"
#include "tools/play/settings.hpp"

namespace hapgrid {

/// What --device names, as path, "walk.txt". Hardware has an adapter; those of hid, spacemouse and
/// evdev lie beside this program, and process names any other.
struct DeviceChoice {
  std::string kind;      ///< what stands before the colon
  std::string argument;  ///< what stands behind it
};

/// Opens nothing. @throw UsageError for what is not a device's name
DeviceChoice parse_device(const std::string& name);

/// The file that tells what the hand does, "-" for standard input; empty for other devices.
std::string input_file(const DeviceChoice& device);
/// What its keys do, in a line for a viewer's screen; empty for a device that reads no keys.
std::string keys_of(const DeviceChoice& device);
/// Whether a person moves the device, for as long as they like.
bool is_live(const DeviceChoice& device);
bool has_adapter(const DeviceChoice& device);

/// The path of a program that lies beside play, an adapter or the guard. @throw Error where the
/// system does not say which folder that is
std::string own_program(const std::string& name);
/// How its adapter is started. @param rate_hz forces a second that were asked for; 0: none
AdapterProgram adapter_program(const DeviceChoice& choice, const PlaySettings& settings,
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

}  // namespace hapgrid
