#include "tools/devices/effects.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/vec3.hpp"
#include "tools/devices/adapter.hpp"

namespace hapgrid {

namespace {

// The events' y and z point towards the user and down.
constexpr double kTurn[] = {1, -1, -1};
constexpr double kFullLevel = 0x7fff;  // of ff_constant_effect
constexpr double kFullMotor = 0xffff;  // of ff_rumble_effect
constexpr double kCircle = 0x10000;    // of ff_effect::direction, clockwise from towards the user
constexpr std::uint16_t kSnapMs = 60;  // motors of gamepads take some 30 ms to turn
/// The share of the strongest effect, at most 1.
double share(const Vec3& force, double newtons) noexcept {
  const double strength = std::sqrt(dot(force, force)) / newtons;
  return finite(force) ? std::min(strength, 1.0) : 0;
}

ff_effect effect(std::uint16_t type, std::uint16_t length_ms) noexcept {
  ff_effect made;
  std::memset(&made, 0, sizeof made);  // padding as well: effects are compared as bytes
  made.type = type;
  made.id = -1;
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
  ff_effect made = effect(FF_CONSTANT, kEvdevEffect);
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
  ff_effect made = effect(FF_RUMBLE, kEvdevEffect);
  made.u.rumble.strong_magnitude =
      static_cast<std::uint16_t>(share(force, parameters.newtons) * kFullMotor);
  return made;
}

ff_effect snap_effect() noexcept {
  ff_effect made = effect(FF_RUMBLE, kSnapMs);
  made.u.rumble.weak_magnitude = static_cast<std::uint16_t>(kFullMotor);
  return made;
}

EvdevLayout usable_layout(EvdevLayout layout, EvdevParameters& parameters) {
  const auto positive = [](const char* what, double value) {
    if (std::isfinite(value) && value > 0) return;
    throw Error(std::string("evdev: ") + what + " " + to_text(value) + ": above 0");
  };
  positive("half range", parameters.half_range);
  positive("newtons", parameters.newtons);
  auto& [x, y] = parameters.signs;
  if (std::abs(x) != 1) throw Error("evdev: sign " + to_text(x) + " of x: 1 or -1");
  if (std::abs(y) != 1 && y != 0) throw Error("evdev: sign " + to_text(y) + " of y: 1, -1 or 0");
  if (layout.constant) {
    layout.axes[2].reset();
    if (!layout.axes[1]) y = 0;
    if (y == 0) layout.axes[1].reset();
  }
  if (!layout.axes[0]) throw DeviceError(layout.name + ": has no stick");
  return layout;
}

hapgrid_device_greeting stick_greeting(const EvdevLayout& layout, const EvdevParameters& parameters,
                                       double rate) {
  const double reach = layout.constant ? parameters.half_range : 1;
  Vec3 high{0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a)
    if (layout.axes[a]) high[a] = reach;
  return made_greeting(layout.name, {-high[0], -high[1], -high[2]}, high,
                       layout.has_force() ? parameters.newtons : 0, rate,
                       HAPGRID_DEVICE_RELEASES | (layout.constant ? 0 : HAPGRID_DEVICE_STEERS));
}

void take_event(const EvdevLayout& layout, const EvdevParameters& parameters,
                const input_event& event, hapgrid_device_state& state) noexcept {
  if (event.type == EV_KEY && event.code >= BTN_MISC) {
    const std::uint32_t flag =
        event.code == layout.second_button ? HAPGRID_DEVICE_NEXT : HAPGRID_DEVICE_RESET;
    state.flags = event.value != 0 ? state.flags | flag : state.flags & ~flag;
  }
  if (event.type != EV_ABS) return;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto& axis = layout.axes[a];
    if (!axis || axis->code != event.code) continue;
    // + 0, because a log should not show -0.
    state.position[a] = layout.constant
                            ? kTurn[a] * parameters.half_range * axis->place(event.value) + 0.0
                            : kTurn[a] * axis->rate(event.value) + 0.0;
    return;
  }
}

}  // namespace hapgrid
