#include "libcore/device/pid.hpp"

#include <algorithm>
#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/hid_report.hpp"

namespace hapgrid {

namespace {

// Signs of HID's x and y in the axes of DeviceInfo::Unit::kMetres: HID's y points to the user.
constexpr double kTurn[] = {1, -1};

void set(HidReport& report, const HidElement& element, std::int64_t value) {
  write_element(report, element, value);  // fits: found in the same descriptor as the report
}

}  // namespace

PidProtocol::PidProtocol(HidDescriptor descriptor, PidParameters parameters)
    : descriptor_(std::move(descriptor)),
      parameters_(std::move(parameters)),
      reports_(find_pid_reports(descriptor_)) {
  const auto positive = [](const char* what, double value) {
    if (std::isfinite(value) && value > 0) return;
    throw Error(std::string("PID: ") + what + " " + to_text(value) + ": above 0");
  };
  positive("half range", parameters_.half_range);
  positive("newtons", parameters_.newtons);
  for (const double sign : parameters_.signs) {
    if (std::abs(sign) != 1) throw Error("PID: sign " + to_text(sign) + ": 1 or -1");
  }
}

DeviceInfo PidProtocol::info() const {
  const double half = parameters_.half_range;
  return {.name = parameters_.name,
          .unit = DeviceInfo::Unit::kMetres,
          .low = {-half, -half, 0},
          .high = {half, half, 0},
          .max_force = parameters_.newtons};  // reached by one axis alone
}

HidReport PidProtocol::report_with(const HidElement& element, std::int64_t value) const {
  HidReport report(descriptor_.report_bytes(element.kind, element.report_id));
  report[0] = element.report_id;
  set(report, element, value);
  return report;
}

HidReport PidProtocol::constant_force(std::int64_t block, std::int64_t magnitude) const {
  HidReport report = report_with(reports_.force_index, block);
  set(report, reports_.magnitude, magnitude);
  return report;
}

/// Creates an effect. @return its block index
std::int64_t PidProtocol::create_effect(HidChannel& channel) const {
  const PidReports& r = reports_;
  channel.set_feature(report_with(r.new_effect_type, r.new_effect_type.choice));
  const std::uint8_t id = r.load_index.report_id;
  const HidReport loaded =
      channel.get_feature(id, descriptor_.report_bytes(HidReportKind::kFeature, id));
  const std::optional<std::int64_t> index = read_element(loaded, r.load_index);
  const std::optional<std::int64_t> status = read_element(loaded, r.load_success);
  if (!index || !status) {
    throw DeviceError("Block Load: " + std::to_string(loaded.size()) + " bytes: too short");
  }
  // When the status has one bit for each outcome, success has a bit of its own.
  if (*status != r.load_success.choice || *index < 1) {
    throw DeviceError("Block Load: the device has no room for an effect: status " +
                      std::to_string(*status) + ", block " + std::to_string(*index));
  }
  return *index;
}

void PidProtocol::start(HidChannel& channel) {
  const PidReports& r = reports_;
  forces_.clear();
  // The reset removes effects of an earlier program.
  channel.write(report_with(r.reset, r.reset.choice));
  channel.write(report_with(r.enable_actuators, r.enable_actuators.choice));
  channel.write(report_with(r.device_gain, r.device_gain.logical_max));
  for (int axis = 0; axis < 2; ++axis) {
    const std::int64_t block = create_effect(channel);
    forces_.push_back(constant_force(block, 0));
    HidReport effect = report_with(r.effect_index, block);
    set(effect, r.effect_type, r.effect_type.choice);
    set(effect, r.duration, -1);  // all ones: no end
    set(effect, r.gain, r.gain.logical_max);
    set(effect, r.direction_enable, r.direction_enable.choice);
    // The range is a whole circle, clockwise from the far side: x at 90 degrees, y at 0.
    const double turn = axis == 0 ? 0.25 : 0;
    const auto range = static_cast<double>(r.direction.logical_max - r.direction.logical_min);
    set(effect, r.direction, r.direction.logical_min + std::llround(turn * range));
    channel.write(effect);
    channel.write(forces_.back());
    HidReport operation = report_with(r.operation_index, block);
    set(operation, r.operation_start, r.operation_start.choice);
    set(operation, r.loop_count, r.loop_count.logical_max);
    channel.write(operation);
  }
}

bool PidProtocol::decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept {
  Vec3 position{0, 0, 0};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const HidElement& element = reports_.axes[axis];
    const std::optional<std::int64_t> value = read_element(report, element);
    if (!value) return false;
    const auto low = static_cast<double>(element.logical_min);
    const auto high = static_cast<double>(element.logical_max);
    // A stick that is pushed a little beyond its range counts as at its end.
    const double share = (static_cast<double>(*value) - low) / (high - low);
    position[axis] = kTurn[axis] * parameters_.half_range * (2 * std::clamp(share, 0.0, 1.0) - 1);
  }
  input.position = position;
  input.reset = reports_.button && read_element(report, *reports_.button) == 1;
  return true;
}

void PidProtocol::encode(const Vec3& force, std::vector<HidReport>& reports) noexcept {
  reports.resize(forces_.size());
  for (std::size_t axis = 0; axis < forces_.size(); ++axis) {
    const auto full = static_cast<double>(
        std::min(reports_.magnitude.logical_max, -reports_.magnitude.logical_min));
    double share = parameters_.signs[axis] * kTurn[axis] * force[axis] / parameters_.newtons;
    if (!std::isfinite(share)) share = 0;
    reports[axis] = forces_[axis];  // of the same size as the last time: no allocation
    // Towards zero, so that the device never gets more than what was sent.
    set(reports[axis], reports_.magnitude,
        static_cast<std::int64_t>(std::clamp(share, -1.0, 1.0) * full));
  }
}

std::vector<HidReport> PidProtocol::stop() const {
  std::vector<HidReport> reports = forces_;
  reports.push_back(report_with(reports_.stop_all, reports_.stop_all.choice));
  for (const HidReport& force : forces_) {
    const std::optional<std::int64_t> block = read_element(force, reports_.force_index);
    reports.push_back(report_with(reports_.free_index, block.value_or(0)));
  }
  return reports;
}

}  // namespace hapgrid
