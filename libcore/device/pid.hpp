// Joysticks with force of the PID class (Device Class Definition for Physical Interface Devices
// 1.0, usage page 0x0f): two axes, a constant force on each.
//
// Report ids and ranges differ from device to device, so every value is found by its usage. Devices
// of this class play effects. This one gets two effects "constant force" that never end, one along
// each axis; from then on only their magnitudes are written.
//
// The class has neither newtons nor metres, and devices do not agree on signs. So the scales are
// parameters, which the user has to measure.
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
  /// Newtons of the largest magnitude that the device takes on each axis; above 0. The default
  /// suits a small stick. With too large a number all forces come out too small.
  double newtons = 2;
  /// The sign, +1 or -1, of a magnitude that pushes to the right (HID's x), and of one that pushes
  /// towards the user (HID's y). The default is the rule of DirectInput, from which the class
  /// comes: a direction tells where the force comes from. So 90 degrees (from the right) pushes to
  /// the left, and 0 degrees (from the far side) towards the user.
  std::array<double, 2> signs{-1, 1};
};

/// The values in the reports of one device.
struct PidReports {
  std::array<HidElement, 2> axes;    ///< X and Y of the input report
  std::optional<HidElement> button;  ///< the first button of that report, if it has one
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

/// Finds two axes and all that two constant forces need.
/// @throw DeviceError that names the first value that is missing or has no sensible range
PidReports find_pid_reports(const HidDescriptor& descriptor);

/// HID's y points to the user, so y changes its sign, in positions and forces. z is 0 and has no
/// force. The first button is DeviceInput::reset.
class PidProtocol : public HidProtocol {
 public:
  /// @throw DeviceError see find_pid_reports(). Error when a parameter is out of its range.
  PidProtocol(HidDescriptor descriptor, PidParameters parameters);

  DeviceInfo info() const override;
  /// A HID device at rest may be silent (Set Idle).
  HidTiming timing() const override { return {.stall = 0}; }
  void start(HidChannel& channel) override;
  bool decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept override;
  /// Saturates at `newtons` on each axis. A force that is not finite counts as zero.
  void encode(const Vec3& force, std::vector<HidReport>& reports) noexcept override;
  /// Zero magnitudes, the stop of all effects, and the freeing of their blocks; before start() only
  /// the stop.
  std::vector<HidReport> stop() const override;

 private:
  /// A report of zeros in which `element` is set.
  HidReport report_with(const HidElement& element, std::int64_t value) const;
  HidReport constant_force(std::int64_t block, std::int64_t magnitude) const;
  std::int64_t create_effect(HidChannel& channel) const;

  HidDescriptor descriptor_;
  PidParameters parameters_;
  PidReports reports_;
  std::vector<HidReport> forces_;  // Set Constant Force of each effect
};

}  // namespace hapgrid
