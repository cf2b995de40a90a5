#include "libcore/device/evdev.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// The events' y and z point towards the user and down.
constexpr double kTurn[] = {1, -1, -1};
constexpr double kFullLevel = 0x7fff;  // of ff_constant_effect
constexpr double kFullMotor = 0xffff;  // of ff_rumble_effect
constexpr double kCircle = 0x10000;    // of ff_effect::direction, clockwise from towards the user
constexpr std::uint16_t kSnapMs = 60;  // motors of gamepads take some 30 ms to turn
constexpr double kForceRest = 4e-3;  // sticks take a report in 1 to 8 ms, and the kernel queues 256
constexpr double kRumbleRest = 10e-3;

template <class Value>
void fill(HidReport& report, EvdevWord word, const Value& value) {
  report.resize(1 + sizeof value);
  report[0] = static_cast<std::uint8_t>(word);
  std::memcpy(&report[1], &value, sizeof value);
}

template <class Value>
HidReport report_of(EvdevWord word, const Value& value) {
  HidReport report;
  fill(report, word, value);
  return report;
}

HidReport setting(std::uint16_t code, int value) {
  input_event event{};
  event.type = EV_FF;
  event.code = code;
  event.value = value;
  return report_of(EvdevWord::kSet, event);
}

/// The share of the strongest effect, at most 1.
double share(const Vec3& force, double newtons) noexcept {
  const double strength = std::sqrt(dot(force, force)) / newtons;
  return finite(force) ? std::min(strength, 1.0) : 0;
}

ff_effect effect(std::uint16_t type, std::uint8_t slot, std::uint16_t length_ms) noexcept {
  ff_effect made;
  std::memset(&made, 0, sizeof made);  // padding as well: reports are compared as bytes
  made.type = type;
  made.id = slot;
  made.replay.length = length_ms;
  return made;
}

}  // namespace

double EvdevAxis::rate(int value) const noexcept {
  const double half = (static_cast<double>(high) - low) / 2;
  const double rest = flat > 0 ? std::min<double>(flat, half / 4) : half / 8;
  const double way = value - (low + half);
  if (std::abs(way) <= rest) return 0;
  return std::clamp((way - std::copysign(rest, way)) / (half - 2 * rest), -1.0, 1.0);
}

double EvdevAxis::place(int value) const noexcept {
  const double half = (static_cast<double>(high) - low) / 2;
  return std::clamp((value - (low + half)) / half, -1.0, 1.0);
}

ff_effect constant_effect(const Vec3& force, const EvdevParameters& parameters) noexcept {
  ff_effect made = effect(FF_CONSTANT, kEvdevForce, kEvdevEffect);
  const Vec3 plane{parameters.signs[0] * force[0], parameters.signs[1] * force[1], 0};
  const double strength = share(plane, parameters.newtons);
  made.u.constant.level = static_cast<std::int16_t>(strength * kFullLevel);
  if (made.u.constant.level == 0) return made;
  // 0: towards the user; a quarter: to the left; a half: away; three quarters: to the right.
  const double turn = std::atan2(-plane[0], -plane[1]) / (2 * std::numbers::pi);
  made.direction = static_cast<std::uint16_t>(std::llround(turn * kCircle));
  return made;
}

ff_effect rumble_effect(const Vec3& force, const EvdevParameters& parameters) noexcept {
  ff_effect made = effect(FF_RUMBLE, kEvdevForce, kEvdevEffect);
  made.u.rumble.strong_magnitude =
      static_cast<std::uint16_t>(share(force, parameters.newtons) * kFullMotor);
  return made;
}

ff_effect snap_effect() noexcept {
  ff_effect made = effect(FF_RUMBLE, kEvdevSnap, kSnapMs);
  made.u.rumble.weak_magnitude = static_cast<std::uint16_t>(kFullMotor);
  return made;
}

EvdevProtocol::EvdevProtocol(EvdevLayout layout, EvdevParameters parameters)
    : layout_(std::move(layout)), parameters_(parameters) {
  const auto positive = [](const char* what, double value) {
    if (std::isfinite(value) && value > 0) return;
    throw Error(std::string("evdev: ") + what + " " + to_text(value) + ": above 0");
  };
  positive("half range", parameters_.half_range);
  positive("newtons", parameters_.newtons);
  auto& [x, y] = parameters_.signs;
  if (std::abs(x) != 1) throw Error("evdev: sign " + to_text(x) + " of x: 1 or -1");
  if (std::abs(y) != 1 && y != 0) throw Error("evdev: sign " + to_text(y) + " of y: 1, -1 or 0");
  if (layout_.constant) {
    layout_.axes[2].reset();
    if (!layout_.axes[1]) y = 0;
    if (y == 0) layout_.axes[1].reset();
  }
  if (!layout_.axes[0]) throw DeviceError(layout_.name + ": has no stick");
}

DeviceInfo EvdevProtocol::info() const {
  DeviceInfo info{.name = layout_.name, .unit = DeviceInfo::Unit::kRate};
  if (has_force()) info.max_force = parameters_.newtons;
  if (!layout_.constant) return info;
  info.unit = DeviceInfo::Unit::kMetres;
  for (std::size_t a = 0; a < 3; ++a)
    if (layout_.axes[a]) {
      info.low[a] = -parameters_.half_range;
      info.high[a] = parameters_.half_range;
    }
  return info;
}

HidTiming EvdevProtocol::timing() const {
  HidTiming timing{.stall = 0};  // events tell changes
  if (!has_force()) return timing;
  timing.keep_alive = 1e-3 * kEvdevEffect / 5;
  timing.rest = layout_.constant ? kForceRest : kRumbleRest;
  // A stick that steers begins at rest: before the first event the kernel says 0, which is an end
  // of an axis from 0 to 255.
  timing.greets = layout_.constant;
  return timing;
}

void EvdevProtocol::start(HidChannel& channel) {
  if (!has_force()) return;
  if (layout_.autocenter) channel.write(setting(FF_AUTOCENTER, 0));
  if (layout_.gain) channel.write(setting(FF_GAIN, 0xffff));
  std::vector<HidReport> reports;
  encode({0, 0, 0}, reports);
  if (!layout_.constant) reports.push_back(report_of(EvdevWord::kEffect, snap_effect()));
  for (const HidReport& report : reports) channel.write(report);
  for (const HidReport& report : keep_alive()) channel.write(report);
}

bool EvdevProtocol::decode(std::span<const std::uint8_t> report, DeviceInput& input) noexcept {
  input_event event;
  if (report.size() != sizeof event) return false;
  std::memcpy(&event, report.data(), sizeof event);
  if (event.type == EV_KEY && event.code >= BTN_MISC) {
    input.reset = event.value != 0;
    return true;
  }
  if (event.type != EV_ABS) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto& axis = layout_.axes[a];
    if (!axis || axis->code != event.code) continue;
    // + 0, because a log should not show -0.
    if (layout_.constant)
      input.position[a] = kTurn[a] * parameters_.half_range * axis->place(event.value) + 0.0;
    else
      input.rate[a] = kTurn[a] * axis->rate(event.value) + 0.0;
    return true;
  }
  return false;
}

void EvdevProtocol::encode(const Vec3& force, std::vector<HidReport>& reports) noexcept {
  reports.resize(has_force() ? 1 : 0);
  if (reports.empty()) return;
  fill(reports[0], EvdevWord::kEffect,
       layout_.constant ? constant_effect(force, parameters_) : rumble_effect(force, parameters_));
}

std::vector<HidReport> EvdevProtocol::keep_alive() const {
  if (!has_force()) return {};
  return {report_of(EvdevWord::kPlay, kEvdevForce)};
}

std::vector<HidReport> EvdevProtocol::snap() const {
  if (layout_.constant || !layout_.rumble) return {};
  return {report_of(EvdevWord::kPlay, kEvdevSnap)};
}

std::vector<HidReport> EvdevProtocol::stop() const {
  if (!has_force()) return {};
  return {{static_cast<std::uint8_t>(EvdevWord::kSilence)}};
}

}  // namespace hapgrid
