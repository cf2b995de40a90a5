// play --device X without a grid: a look at a device.
#pragma once

#include "libcore/device/process_device.hpp"

namespace hapgrid {

/// Shows on standard output where the handle is, its buttons, and how many answers come in a
/// second, until a signal comes or the time is over. The device gets no force.
/// @param rate_hz how often the device is asked; 0: as often as it can, 1000 at most.
/// @param duration_s 0: for ever. @return the exit code @throw DeviceError
int try_device(ProcessDevice& device, double rate_hz, double duration_s);

}  // namespace hapgrid
