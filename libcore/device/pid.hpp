// Joysticks with force of the PID class (Device Class Definition for Physical Interface Devices
// 1.0, usage page 0x0f): two axes, a constant force on each.
//
// Report ids and ranges differ from device to device; every value is found by its usage. The device
// plays effects by itself; here it gets two, "constant force", that last for ever, one along each
// axis, and from then on only their magnitudes are written.
//
// The class knows neither newtons nor metres, and devices do not agree on signs: the scales are
// parameters, to be found by measuring.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "libcore/device/hid_descriptor.hpp"
#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

struct PidParameters {
  std::string name = "PID joystick";  ///< DeviceInfo::name
  /// Metres from the middle to the end of each axis' logical range; above 0.
  double half_range = 0.05;
  /// Newtons of the largest magnitude that the device takes, on each axis; above 0. The default is
  /// what a small stick holds; with more than the truth all forces come out too small.
  double newtons = 2;
  /// +1 or -1 for HID's x and y: the sign of the magnitude that pushes in the axis' positive
  /// direction, to the right and towards the user.
  /// The default is DirectInput's rule, which the class comes from: a direction is where the force
  /// comes from, so at 90 degrees (from the right) it pushes to the left, at 0 degrees (from the
  /// far side) towards the user.
  std::array<double, 2> signs{-1, 1};
  /// HidTiming::stall. 0: a HID device at rest may be silent (Set Idle).
  double stall = 0;
};

/// The reports of one device, found in its descriptor.
struct PidReports {
  std::array<HidElement, 2> axes;    ///< X and Y of the input report
  std::optional<HidElement> button;  ///< the first one of that report, if there is any
  // Set Effect
  HidElement effect_index, effect_type, duration, gain, direction_enable, direction;
  // Set Constant Force
  HidElement force_index, magnitude;
  // Effect Operation
  HidElement operation_index, operation_start, loop_count;
  // Device Control
  HidElement enable_actuators, stop_all, reset;
  HidElement device_gain;
  HidElement free_index;
  // Feature reports: Create New Effect, Block Load
  HidElement new_effect_type, load_index, load_success;
};

/// @throw DeviceError that names the first report or value that is not there or has no sensible
/// range: two axes, and all that two constant forces need.
PidReports find_pid_reports(const HidDescriptor& descriptor);

/// HID's y is towards the user: it is turned, in positions and forces. z is 0 and has no force. The
/// first button is DeviceInput::reset.
class PidProtocol : public HidProtocol {
 public:
  /// @throw DeviceError see find_pid_reports(). Error when a parameter is out of its range.
  PidProtocol(HidDescriptor descriptor, PidParameters parameters);

  DeviceInfo info() const override;
  HidTiming timing() const override { return {.stall = parameters_.stall}; }
  void start(HidChannel& channel) override;
  bool decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept override;
  /// Saturates at `newtons` on each axis; what is not finite is no force.
  void encode(const Vec3& force, std::vector<HidReport>& reports) noexcept override;
  /// Zero magnitudes, stop of all effects, blocks freed; before start(), only the stop.
  std::vector<HidReport> stop() const override;

 private:
  /// A report of zeros that `element` is in, with `element` set.
  HidReport report_with(const HidElement& element, std::int64_t value) const;
  HidReport constant_force(std::int64_t block, std::int64_t magnitude) const;
  std::int64_t create_effect(HidChannel& channel) const;

  HidDescriptor descriptor_;
  PidParameters parameters_;
  PidReports reports_;
  std::vector<HidReport> forces_;  // Set Constant Force of each effect that was created
};

}  // namespace hapgrid
