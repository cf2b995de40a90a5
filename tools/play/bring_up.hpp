// play --device X without a grid, at a terminal: the first hour of a device.
#pragma once

#include <string>

#include "libcore/device/process_device.hpp"

namespace hapgrid {

/// Finds out which axes and signs a device has, in which steps and how noisily it measures, and, if
/// the person at the terminal says yes, which way its forces push and how late they act, with 0.1 N
/// at most. Asks at the terminal of standard input, and writes to standard output a table [play]
/// for --config. All forces pass the safety core, and every way out sends zero force.
/// @param option the text of --device. @param rate_hz 0: as often as it can, 1000 at most.
/// @return the exit code @throw DeviceError; Error when the talk came to no result
int bring_up(ProcessDevice& device, const std::string& option, double rate_hz);

}  // namespace hapgrid
