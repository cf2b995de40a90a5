// Which device the command line names, and opening it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "libcore/device/device.hpp"
#include "libcore/device/hid_guard.hpp"
#include "libcore/device/process_guard.hpp"
#include "libcore/device/simulated.hpp"
#include "libcore/session/recording.hpp"
#include "tools/play/settings.hpp"

namespace hapgrid {

// What --device can name. A WHICH tells devices of one kind apart (parse_hid_match()); an empty one
// means the only one.
struct PathFile {
  std::string file;  ///< "-": standard input
};
struct HandPipe {
  std::string pipe;  ///< a named pipe
};
struct ReplayFile {
  std::string file;
};
struct SimulationFile {
  std::string file;
};
struct TerminalKeys {};
struct ProfileFile {
  std::string file;
};
struct EvdevStick {
  std::string which;
};
struct SpaceMouse {
  std::string which;
};
struct AdapterProcess {
  std::vector<std::string> command;  ///< at least one word
};
using DeviceChoice = std::variant<PathFile, HandPipe, ReplayFile, SimulationFile, TerminalKeys,
                                  ProfileFile, EvdevStick, SpaceMouse, AdapterProcess>;

/// Opens nothing. A path that is a named pipe is a hand. @throw UsageError for what is not a
/// device's name
DeviceChoice parse_device(const std::string& name);

/// The file or pipe that tells what the hand does, "-" for standard input; empty for other devices.
std::string input_file(const DeviceChoice& device);
/// What its keys do, in a line for a viewer's screen; empty for a device that reads no keys.
std::string keys_of(const DeviceChoice& device);
/// Whether a person moves the device, for as long as they like.
bool is_live(const DeviceChoice& device);

/// The guard process of a device that pushes a hand, so that its force ends even when this program
/// is killed. Make it before there is a thread, or a grid that it would copy.
struct DeviceGuard {
  explicit DeviceGuard(const DeviceChoice& device);
  std::optional<HidGuard> hid;
  std::optional<ProcessGuard> process;
};

/// A device that is open, and what play has to know about it.
struct OpenDevice {
  std::unique_ptr<Device> device;
  std::size_t ticks = ~std::size_t{0};         ///< how many a path or a replay has
  std::optional<SessionHeader> session;        ///< of a replay
  const SimulatedDevice* simulated = nullptr;  ///< `device`, if it is one
  bool wants_truth = false;                    ///< of a simulation: the model runs beside it
  double rate_hz = 0;                          ///< the most that an adapter can take; 0: not known
};

/// @param virtual_hz ticks a second of a simulation, and of a replayed text, which does not say it.
/// @param box of the grid. @param guard of this device; it must live longer.
/// @throw DeviceError, Error, std::system_error
OpenDevice open_device(const DeviceChoice& device, const PlaySettings& settings, double virtual_hz,
                       const Box& box, DeviceGuard& guard);

/// Prints what --list-devices asks for.
void print_devices();

}  // namespace hapgrid
