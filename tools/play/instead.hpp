// What play does instead of playing.
#pragma once

#include <set>
#include <string>

#include "libcore/device/process_device.hpp"
#include "tools/play/options.hpp"

namespace hapgrid {

// --selftest: whether this machine can hold a haptic loop.

/// Runs the loop without a device, in turns with a bare loop of clock_nanosleep(), which measures
/// what cyclictest does, and prints both with a grade. @return an exit code
int run_selftest(const PlayOptions& options);

// --list-devices.

/// All devices that our adapters find, and the adapters that lie in the folder ../devices beside
/// this program, as a table that begins with the text for --device. What keeps the user from
/// opening a device stands below it, a line each.
std::string devices_table();
/// The last part of it: what keeps the user from opening devices.
std::set<std::string> permissions_lacking();

// --device X without a grid: a look at a device, or at a terminal, its first hour.

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

/// Finds out which axes and signs a device has, in which steps and how noisily it measures, and, if
/// the person at the terminal says yes, which way its forces push and how late they act, with 0.1 N
/// at most. Asks at the terminal of standard input, and writes to standard output a table [play]
/// for --config. All forces pass the safety core, and every way out sends zero force.
/// @param option the text of --device. @param rate_hz 0: as often as it can, 1000 at most.
/// @return the exit code @throw DeviceError; Error when the talk came to no result
int bring_up(ProcessDevice& device, const std::string& option, double rate_hz);

}  // namespace hapgrid
