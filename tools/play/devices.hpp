// Which device the command line names, and opening it.
#pragma once

#include <memory>
#include <string>

#include "libcore/device/device.hpp"
#include "tools/play/options.hpp"

namespace hapgrid {

inline constexpr const char* kDeviceForms =
    "path:FILE moves the HIP through the positions in FILE ('path:-': standard input); keys is the "
    "terminal's keyboard";

/// What is wrong with a device's name; empty when nothing is. Opens nothing.
std::string device_mistake(const std::string& name);

/// A device that is open, and what play has to know of it.
struct OpenDevice {
  std::unique_ptr<Device> device;
  bool live = true;       ///< a hand: it needs a pace
  std::size_t ticks = 0;  ///< how many it has, where it is not live
};

/// @param box of the grid. @throw DeviceError, Error, std::system_error
OpenDevice open_device(const PlayOptions& options, const Box& box);

/// Whether the device reads standard input.
bool reads_standard_input(const std::string& name);

}  // namespace hapgrid
