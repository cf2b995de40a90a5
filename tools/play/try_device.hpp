// play --device X without a grid: a look at a device.
#pragma once

#include <string>

#include "libcore/device/process_device.hpp"

namespace hapgrid {

/// How often a device without a grid is asked in a second, at most.
inline constexpr double kMostTriedHz = 1000;

/// What is there, in a line.
std::string device_text(const ProcessDevice& device);
/// "x  -40.00 mm  y ...". @param place of the handle in metres, or its deflection
std::string place_text(const DeviceInfo& info, const Vec3& place);

/// Shows on standard output where the handle is, its buttons, and how many answers come in a
/// second, until a signal comes or the time is over. The device gets no force.
/// @param rate_hz how often the device is asked; 0: as often as it can, 1000 at most.
/// @param duration_s 0: for ever. @return the exit code @throw DeviceError
int try_device(ProcessDevice& device, double rate_hz, double duration_s);

}  // namespace hapgrid
