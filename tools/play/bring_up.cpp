#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/loop/realtime.hpp"
#include "tools/common/signals.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/bring_up_measures.hpp"
#include "tools/play/handle.hpp"
#include "tools/play/instead.hpp"

namespace hapgrid {

namespace {

constexpr double kForce = 0.1;         // newtons
constexpr double kRiseSeconds = 1;     // from zero to kForce
constexpr double kRestSeconds = 1;     // in which noise and rate are measured
constexpr double kAnswerSeconds = 20;  // for which a device pushes at most
constexpr std::uint64_t kShakes = 6;   // repetitions of the pattern; the first settles
constexpr double kLeastMove = 15e-3, kLeastPart = 0.3;  // metres; part of full deflection
constexpr double kMostTremor = 3e-3;                    // metres; a hand at rest has 0.3 mm
constexpr int kAttempts = 3;
constexpr std::array kWays{"to the right", "away from you", "up"};
// The letters of the directions, of their opposites, and of no motion.
constexpr char kAhead[] = "rau", kBack[] = "ltd", kNothing = 'n';

/// The axis of the device that a direction of the person follows, and whether it goes the same way.
struct Found {
  int axis;
  double sign;
};

class BringUp {
 public:
  BringUp(ProcessDevice& device, const std::string& option, double rate_hz)
      : info_(device.info()),
        option_(option),
        handle_(device, rate_hz),
        steers_(info_.unit == DeviceInfo::Unit::kRate) {}

  /// @throw Error, DeviceError, Interrupted
  void talk() {
    rest();
    for (int direction = 0; direction < 3; ++direction) found_[direction] = follow(direction);
    say("play", format("axes: {}; steps of {} mm", axes_text(), rounded(1000 * step_)));
    if (info_.max_force == 0 || steers_)
      say("play", "it pushes nobody: no force is tried");
    else if (agreed())
      try_forces();
    std::fputs(table().c_str(), stdout);
    say("play",
        "done. The table on standard output is for play GRID --device ... --config FILE, if FILE "
        "has it");
  }

 private:
  bool has(int axis) const { return info_.low[axis] != info_.high[axis]; }

  void rest() {
    std::string why;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      handle_.ask(why + "Hold the handle still in the middle of its reach, and press Enter.");
      noise_ = noise_of(handle_.record(kRestSeconds));
      if (steers_ || noise_ < kMostTremor) break;
      why = format("It moved by {} mm in {} s. ", rounded(1000 * noise_), rounded(kRestSeconds));
    }
    if (!steers_ && noise_ >= kMostTremor) throw Error("bring-up: the handle is not at rest");
    say("play", format("at rest: {} answers/s, {}", rounded(handle_.answers_hz()),
                       steers_ ? std::string("a deflection")
                               : format("noise and tremor of {} mm", rounded(1000 * noise_))));
  }

  /// @return nothing for a direction in which a device with fewer axes cannot move
  std::optional<Found> follow(int direction) {
    std::string why;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const Vec3 from = steers_ ? Vec3{0, 0, 0} : handle_.place();
      const std::vector<Vec3> way =
          handle_.ask(format("{}{} {}{}, hold it there, and press Enter.", why,
                             steers_ || direction == 0 ? "Move it" : "From there, move it",
                             kWays[direction], steers_ ? "" : " by 2 cm or more"));
      if (!steers_) step_ = std::max(step_, encoder_step(way));
      const Vec3 moved = handle_.place() - from;
      int axis = 0;
      for (int a = 1; a < 3; ++a)
        if (std::abs(moved[a]) > std::abs(moved[axis])) axis = a;
      const double most = std::abs(moved[axis]);
      const double other =
          std::max(std::abs(moved[(axis + 1) % 3]), std::abs(moved[(axis + 2) % 3]));
      const bool is_new = std::none_of(found_.begin(), found_.end(),
                                       [&](const auto& f) { return f && f->axis == axis; });
      const bool moves = most > (steers_ ? kLeastPart : kLeastMove);
      if (!moves && !(has(0) && has(1) && has(2))) return std::nullopt;
      if (moves && other < most / 2 && is_new) return Found{axis, moved[axis] > 0 ? 1.0 : -1.0};
      why = !moves   ? "It did not move far enough. "
            : is_new ? "It moved along two of its axes. "
                     : format("Only its {} moved, as before. ", "xyz"[axis]);
    }
    throw Error(
        format("bring-up: {} times no axis of the device followed a motion {} alone: begin again, "
               "in case an earlier motion went another way than it was asked for",
               kAttempts, kWays[direction]));
  }

  bool agreed() {
    handle_.ask(
        format("Now hold it loosely in the middle. May it push you with up to {} N, along one "
               "axis after the other? Type yes, or only Enter for no.",
               rounded(kForce)));
    tried_ = handle_.answer() == "yes";
    if (!tried_) say("play", "no force is tried, so the table allows none");
    return tried_;
  }

  void try_forces() {
    std::vector<Shaken> shaken;
    for (int axis = 0; axis < 3; ++axis)
      if (has(axis)) push_[axis] = push(axis);
    if (std::any_of(push_.begin(), push_.end(), [](double p) { return p == 0; })) return;
    say("play", "now it shakes for some seconds: hold it loosely");
    for (int axis = 0; axis < 3; ++axis) {
      if (!has(axis)) continue;
      Shaken& of_axis = shaken.emplace_back();
      for (std::uint64_t tick = 0; tick < kShakes * kShakeTicks; ++tick) {
        Vec3 force{0, 0, 0};
        force[axis] = kForce * shake(tick);
        const double answered = handle_.sent()[axis];  // by the place that comes now
        handle_.tick(force);
        // The first repetition still has the beginning in it.
        if (tick >= kShakeTicks) of_axis.add(tick, answered, handle_.place()[axis]);
      }
      handle_.fade();
    }
    delay_ = delay_of(shaken);
    say("play", delay_
                    ? format("a force acts after {} ticks of {} ms", *delay_,
                             rounded(1000 / handle_.rate_hz()))
                    : std::string("it did not follow the force clearly: the delay is not known"));
  }

  /// @return 1 where a force along this axis of the device pushes that way, -1 the other way, 0
  /// where it is not felt
  double push(int axis) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      handle_.tell(
          format("It pushes now, for {} s at most. Which way? r(ight), l(eft), a(way), t(owards "
                 "you), u(p), d(own), or n for nothing; then Enter.",
                 rounded(kAnswerSeconds)));
      Vec3 force{0, 0, 0};
      const double ticks = kRiseSeconds * handle_.rate_hz();
      const double most = kAnswerSeconds * handle_.rate_hz();
      bool answered = false;
      for (double tick = 0; tick < most && !answered; ++tick) {
        force[axis] = kForce * std::min(1.0, tick / ticks);
        answered = handle_.tick(force);
      }
      handle_.fade();
      const std::string& word = handle_.answer();
      const char letter = answered && !word.empty() ? word[0] : ' ';
      if (letter == kNothing) return 0;
      for (int direction = 0; direction < 3; ++direction) {
        if (letter != kAhead[direction] && letter != kBack[direction]) continue;
        const std::optional<Found>& way = found_[direction];
        if (!way || way->axis != axis)
          throw Error(
              format("bring-up: a force along its {} pushes along another axis: correct the "
                     "axes of the adapter or its profile",
                     "xyz"[axis]));
        const double sign = (letter == kAhead[direction] ? 1 : -1) * way->sign;
        say("play", format("along its {} it pushes {}", "xyz"[axis],
                           sign > 0 ? "the way it moves" : "against the way it moves"));
        return sign;
      }
    }
    throw Error("bring-up: nobody says which way the device pushes");
  }

  /// As the key axes has them. What did not move gets the axis that is left.
  std::string axes_text() const {
    std::string text;
    std::array<bool, 3> taken{};
    for (const auto& f : found_)
      if (f) taken[f->axis] = true;
    for (const auto& f : found_) {
      const int axis =
          f ? f->axis
            : static_cast<int>(std::find(taken.begin(), taken.end(), false) - taken.begin());
      taken[axis] = true;
      text += format("{}{}{}", text.empty() ? "" : ",", f && f->sign < 0 ? "-" : "", "xyz"[axis]);
    }
    return text;
  }

  /// What keeps the forces of a play away until somebody has looked at it; empty: nothing.
  std::string fault() const {
    if (!tried_) return "no force was tried: bring it up again, and allow one";
    std::string wrong, missing;
    for (int axis = 0; axis < 3; ++axis) {
      if (push_[axis] < 0) wrong += "xyz"[axis];
      if (push_[axis] == 0) missing += "xyz"[axis];
    }
    if (!missing.empty()) return format("no force was felt along {}: is it switched on?", missing);
    if (wrong.empty()) return "";
    return format(
        "it pushes the wrong way along {}, or you moved it the other way than it was asked for: "
        "bring it up "
        "again. If it says the same, correct the adapter, or put mapping.push = [{:g},{:g},{:g}] "
        "in place of "
        "max-force",
        wrong, push_[0], push_[1], push_[2]);
  }

  double most_force() const { return std::min(SafetyLimits().max_force, info_.max_force); }

  std::string table() const {
    const SafetyLimits usual;
    std::string text = format("# {}, by play --device '{}'\n[play]\naxes = \"{}\"\n",
                              printable_line(info_.name, info_.name.npos),
                              printable_line(option_, option_.npos), axes_text());
    if (steers_ || info_.max_force == 0) return text;
    if (const std::string why = fault(); !why.empty()) {
      if (tried_) say("play", why);
      text += format("max-force = 0  # {}\n", why);
    } else {
      text += format("max-force = {}\n", to_text(most_force()));
    }
    text += format("[play.safety]\nencoder = {:g}  # m; {} mm of noise and tremor at rest\n",
                   std::max(usual.encoder, round_up(step_)), rounded(1000 * noise_));
    if (delay_)
      text += format("delay = {}  # ticks, at {} Hz\n", *delay_, rounded(handle_.rate_hz()));
    return text;
  }

  /// To a tenth of a micrometre.
  static double round_up(double metres) { return std::ceil(metres * 1e7 - 1e-3) / 1e7; }

  const DeviceInfo info_;
  const std::string option_;
  Handle handle_;
  const bool steers_;
  double noise_ = 0, step_ = 0;
  std::array<std::optional<Found>, 3> found_{};
  std::array<double, 3> push_{1, 1, 1};
  bool tried_ = false;
  std::optional<std::uint32_t> delay_;
};

}  // namespace

int bring_up(ProcessDevice& device, const std::string& option, double rate_hz) {
  say("play", device_text(device));
  say("play",
      "bring-up: what it finds goes to standard output, for --config. It sends no force before you "
      "say yes. Ctrl-C ends it.");
  const double rate = rate_hz > 0 ? rate_hz : std::min(device.rate_hz(), kMostTriedHz);
  const Realtime realtime(RealtimeMode::kTry, &device);
  say("play", format("real time: {}", realtime.got()));
  try {
    BringUp(device, option, rate).talk();
  } catch (const Interrupted&) {
    device.stop();
    return 128 + caught_signal;
  }
  if (device.stop() != DeviceStatus::kOk)
    throw DeviceError(format("device: did not take the last zero force: {}", device.error()));
  return kExitDone;
}

}  // namespace hapgrid
