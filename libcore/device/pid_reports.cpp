// Finds the reports of the PID class by their usages.
#include <initializer_list>

#include "libcore/base/error.hpp"
#include "libcore/device/pid.hpp"

namespace hapgrid {

namespace {

using Kind = HidReportKind;

/// A usage of the Physical Interface page.
constexpr HidUsage pid(std::uint16_t id) { return {0x0f, id}; }

class Finder {
 public:
  explicit Finder(const HidDescriptor& descriptor) : descriptor_(descriptor) {}

  /// @param report usage of the collection that is the report; nothing: any collection
  HidElement find(const std::string& what, Kind kind, HidUsage usage,
                  std::optional<HidUsage> report) const {
    const std::optional<HidElement> found = descriptor_.find(kind, usage, report);
    if (!found) throw DeviceError("no PID device with two axes: it has no " + what);
    if (found->bit_size > 32 || found->logical_max <= found->logical_min) {
      throw DeviceError("no PID device with two axes: the range of its " + what + " is empty");
    }
    return *found;
  }

 private:
  const HidDescriptor& descriptor_;
};

/// A number that is written must not lose its upper bits, or a force would change its direction.
void fits(const std::string& what, const HidElement& element) {
  const std::int64_t end = std::int64_t{1}
                           << (element.logical_min < 0 ? element.bit_size - 1 : element.bit_size);
  if (element.logical_max < end && element.logical_min >= -end) return;
  throw DeviceError("no PID device with two axes: its " + what + " goes to " +
                    std::to_string(element.logical_max) + " in " +
                    std::to_string(element.bit_size) + " bits");
}

/// Values that are written or read together must be in one report.
void together(const std::string& report, std::initializer_list<HidElement> elements) {
  for (const HidElement& element : elements) {
    if (element.report_id == elements.begin()->report_id) continue;
    throw DeviceError("no PID device with two axes: its " + report + " is spread over reports " +
                      std::to_string(elements.begin()->report_id) + " and " +
                      std::to_string(element.report_id));
  }
}

}  // namespace

PidReports find_pid_reports(const HidDescriptor& descriptor) {
  const Finder finder(descriptor);
  const auto output = [&](const char* what, std::uint16_t usage, std::uint16_t report) {
    return finder.find(what, Kind::kOutput, pid(usage), pid(report));
  };
  PidReports r;
  const char* const axes[] = {"X axis", "Y axis"};
  const char* const actuators[] = {"Set Effect report for forces along X",
                                   "Set Effect report for forces along Y"};
  for (std::uint16_t axis = 0; axis < 2; ++axis) {
    const HidUsage usage{0x01, static_cast<std::uint16_t>(0x30 + axis)};
    r.axes[axis] = finder.find(axes[axis], Kind::kInput, usage, std::nullopt);
    // Axes Enable lists the axes that have a motor: pedals are a Y axis too.
    finder.find(actuators[axis], Kind::kOutput, usage, pid(0x55));
  }
  const std::optional<HidElement> button =
      descriptor.find(Kind::kInput, {0x09, 1}, std::nullopt, r.axes[0].report_id);
  if (button && button->variable) r.button = button;
  r.effect_index = output("Set Effect report (block index)", 0x22, 0x21);
  r.effect_type = output("Set Effect report (constant force)", 0x26, 0x21);
  r.duration = output("Set Effect report (duration)", 0x50, 0x21);
  r.gain = output("Set Effect report (gain)", 0x52, 0x21);
  r.direction_enable = output("Set Effect report (direction enable)", 0x56, 0x21);
  // The first of the directions: usage page Ordinals, instance 1.
  r.direction = finder.find("Set Effect report (direction)", Kind::kOutput, {0x0a, 1}, pid(0x57));
  r.force_index = output("Set Constant Force report (block index)", 0x22, 0x73);
  r.magnitude = output("Set Constant Force report (magnitude)", 0x70, 0x73);
  if (r.magnitude.logical_min >= 0 || r.magnitude.logical_max <= 0)
    throw DeviceError("no PID device with two axes: its magnitudes have one sign only");
  r.operation_index = output("Effect Operation report (block index)", 0x22, 0x77);
  r.operation_start = output("Effect Operation report (start)", 0x79, 0x77);
  r.loop_count = output("Effect Operation report (loop count)", 0x7c, 0x77);
  // Around Device Control (0x96) some have a report collection (0x95), some have not.
  const auto control = [&](const char* what, std::uint16_t usage) {
    return finder.find(what, Kind::kOutput, pid(usage), std::nullopt);
  };
  r.enable_actuators = control("Device Control report (enable actuators)", 0x97);
  r.stop_all = control("Device Control report (stop all effects)", 0x99);
  r.reset = control("Device Control report (reset)", 0x9a);
  r.device_gain = output("Device Gain report", 0x7e, 0x7d);
  r.free_index = output("Block Free report", 0x22, 0x90);
  const auto feature = [&](const char* what, std::uint16_t usage, std::uint16_t report) {
    return finder.find(what, Kind::kFeature, pid(usage), pid(report));
  };
  r.new_effect_type = feature("Create New Effect report (constant force)", 0x26, 0xab);
  r.load_index = feature("Block Load report (block index)", 0x22, 0x89);
  r.load_success = feature("Block Load report (success)", 0x8c, 0x89);
  fits("magnitude", r.magnitude);
  fits("direction", r.direction);
  fits("gain", r.gain);
  fits("device gain", r.device_gain);
  fits("loop count", r.loop_count);
  together("X and Y axis", {r.axes[0], r.axes[1]});
  together("Set Effect report",
           {r.effect_index, r.effect_type, r.duration, r.gain, r.direction_enable, r.direction});
  together("Set Constant Force report", {r.force_index, r.magnitude});
  together("Effect Operation report", {r.operation_index, r.operation_start, r.loop_count});
  together("Block Load report", {r.load_index, r.load_success});
  return r;
}

}  // namespace hapgrid
