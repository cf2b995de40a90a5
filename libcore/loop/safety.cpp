#include "libcore/loop/safety.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

// Forces stay this far below a limit, so that a check of the two promises that rounds differently
// holds as well.
constexpr double kMargin = 1 - 1e-12;

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// Seconds over which the hand's speed is smoothed: one step of a coarse encoder at 5 kHz looks
// fast.
constexpr double kSpeedTime = 0.01;
// A hand that was too fast is trusted again below this part of the limit.
constexpr double kCalmSpeed = 0.5;
// Seconds over which swings are counted: three times longer than a hand's slowest tremor.
constexpr double kBuzzTime = 0.25;
// Buzzing is over below this part of buzz_rate.
constexpr double kCalmBuzz = 0.25;

/// Scales f to the magnitude `limit` when it is larger. @return whether it was
bool clamp_magnitude(Vec3& f, double limit) {
  // Through the largest component, since the square of a finite force can be infinite or zero.
  const double largest = std::max({std::abs(f[0]), std::abs(f[1]), std::abs(f[2])});
  if (largest == 0) return false;
  const Vec3 unit = 1 / largest * f;
  // 1 / largest is infinite for a denormal: such a small force counts as zero.
  if (!finite(unit)) {
    f = {0, 0, 0};
    return false;
  }
  const double scale = limit / length_of(unit) * kMargin;
  if (largest <= scale) return false;
  f = scale * unit;
  return true;
}

/// What the energy tank counts on.
TankTerms tank_terms(const SafetyLimits& limits, const SafetyInput& input) {
  return {.reserve = limits.reserve / 1000,
          .acceleration = limits.acceleration,
          .encoder = limits.encoder,
          .delay = static_cast<std::uint32_t>(limits.delay_ticks),
          .slew = limits.slew * 1000,
          .period = input.dt / (1 + static_cast<double>(input.missed))};
}

/// Zero at once. Later forces start from there; all else outlives the zero, so that its end can be
/// seen.
SafeForce let_go(SafetyState& state, std::uint32_t why) {
  state.sent = {0, 0, 0};
  state.ramp = 0;
  return {.force = state.sent, .acted = why};
}

void watch_speed(const SafetyLimits& limits, SafetyState& state, const SafetyInput& input) {
  state.speed += (input.speed - state.speed) * (input.dt / (kSpeedTime + input.dt));
  if (state.speed > limits.max_speed) state.too_fast = true;
  if (state.speed <= kCalmSpeed * limits.max_speed) state.too_fast = false;
}

/// Counts turning points of the force. A limit cycle at a stiff wall (on, off, on) has them, and so
/// has a force that flips its direction. A turning point is the force farthest from the turning
/// point before it; it counts once the force has come back from it by buzz_force. All directions
/// are treated alike.
void watch_buzz(const SafetyLimits& limits, SafetyState& state, Vec3 wanted, double dt) {
  clamp_magnitude(wanted, limits.max_force);  // as far as it can be felt
  state.swings *= kBuzzTime / (kBuzzTime + dt);
  const auto apart = [](const Vec3& a, const Vec3& b) { return length_of(a - b); };
  if (apart(wanted, state.anchor) >= apart(state.extreme, state.anchor)) {
    state.extreme = wanted;
  } else if (apart(wanted, state.extreme) >= limits.buzz_force) {
    state.anchor = state.extreme;
    state.extreme = wanted;
    state.swings += 1;
  }
  const double rate = state.swings / kBuzzTime;
  if (rate > kBuzzStop * limits.buzz_rate) state.buzzing = true;
  if (rate < kCalmBuzz * limits.buzz_rate) state.buzzing = false;
}

/// Why the force must be zero at once; 0 when it need not be.
std::uint32_t reason_for_zero(const SafetyLimits& limits, SafetyState& state,
                              const SafetyInput& input, const Vec3& wanted) {
  const bool sound = std::isfinite(input.dt) && input.dt > 0 && std::isfinite(input.speed) &&
                     !std::isnan(input.outside_cells);
  if (!sound || !finite(wanted) || input.unusable) state.faulted = true;
  if (state.faulted) return kFault;
  if (input.stalled) return kStalled;
  watch_speed(limits, state, input);
  watch_buzz(limits, state, wanted, input.dt);
  if (static_cast<double>(input.missed) >= limits.watchdog_ticks) return kMissed;
  if (state.too_fast) return kTooFast;
  return state.buzzing ? std::uint32_t{kBuzzing} : 0;
}

/// Charges the tank for what happened since the tick before. @return whether it limits forces
bool watch_energy(const SafetyLimits& limits, SafetyState& state, const SafetyInput& input,
                  const TankTerms& terms) {
  const bool clutched = std::exchange(state.clutched, input.clutch);
  if (!(limits.reserve < kUnlimited)) return false;
  const bool seen = input.place && finite(*input.place) && std::isfinite(input.dt) && input.dt > 0;
  if (input.stalled || !seen) {
    state.tank.lose_sight();
    return false;
  }
  // While the clutch is held the handle moves, and the HIP does not.
  if (input.clutch && !clutched) state.tank.let_go_unseen(terms);
  if (input.clutch) return false;
  state.tank.move(terms, *input.place, input.dt, input.missed == 0);
  return true;
}

/// From the force that is wanted to the one that keeps slew and limit, in one call because both
/// look at the force of the tick before.
void slew_and_clamp(const SafetyLimits& limits, const Vec3& sent, double step, Vec3& force,
                    std::uint32_t& acted) {
  // In halves, because the difference of two finite forces can be infinite.
  Vec3 half_step = 0.5 * force - 0.5 * sent;
  if (clamp_magnitude(half_step, step / 2)) {
    force = sent + 2 * half_step;
    acted |= kSlewed;
  }
  if (clamp_magnitude(force, limits.max_force)) acted |= kClamped;
}

SafeForce limit(const SafetyLimits& limits, SafetyState& state, const SafetyInput& input,
                const TankTerms& terms, bool tank) {
  Vec3 force = limits.gain * input.force;
  if (const std::uint32_t why = reason_for_zero(limits, state, input, force))
    return let_go(state, why);

  SafeForce safe;
  const auto scale = [&](double by, SafetyAction action) {
    if (by >= 1) return;
    force = (by > 0 ? by : 0) * force;  // a factor that is NaN counts as 0
    safe.acted |= action;
  };
  if (limits.fade_cells > 0 && input.outside_cells > 0)
    scale(1 - input.outside_cells / limits.fade_cells, kFaded);
  if (state.swings > 0) scale(limits.buzz_rate * kBuzzTime / state.swings, kDamped);
  const double before = input.chosen ? 0 : state.ramp;
  if (input.clutch) {
    state.ramp = 0;
    scale(0, kClutched);
  } else {
    state.ramp = limits.ramp_ms > 0 ? std::min(1.0, before + input.dt * 1000 / limits.ramp_ms) : 1;
    scale(state.ramp, kRamped);
    if (before < 1)
      state.tank.ramp(before, state.ramp, input.model_energy.value_or(0));
    else if (tank && input.model_energy)
      state.tank.refill(*input.model_energy, input.dt);
  }

  const auto spend = [&](const Vec3& affordable) {
    if (force != affordable) safe.acted |= kEnergy;
    force = affordable;
  };
  if (tank) {
    // What will not be sent need not be withheld.
    if (clamp_magnitude(force, limits.max_force)) safe.acted |= kClamped;
    const bool goes_on = before > 0 && !input.jumped && input.missed == 0;
    const Vec3 lead = state.tank.lead(terms, force, goes_on);
    spend(state.tank.soften(terms, force, input.dt));
    force = force + lead;
  }
  const double step = limits.slew * 1000 * std::min(input.dt, input.slew_dt);
  slew_and_clamp(limits, state.sent, step, force, safe.acted);
  if (tank) spend(state.tank.bound(terms, force, state.sent, step * kMargin));
  safe.force = state.sent = force;
  return safe;
}

}  // namespace

SafeForce limit_force(const SafetyLimits& limits, SafetyState& state,
                      const SafetyInput& input) noexcept {
  const TankTerms terms = tank_terms(limits, input);
  const bool tank = watch_energy(limits, state, input, terms);
  const SafeForce safe = limit(limits, state, input, terms, tank);
  const std::optional<double> before = std::exchange(state.account, input.account);
  std::optional<double> lost;
  if (before && input.account && !input.jumped) lost = state.ramp * (*before - *input.account);
  if (tank || input.clutch) state.tank.sent(safe.force, lost);
  return safe;
}

void SafetyCore::reset() noexcept {
  const EnergyTank tank = state_.tank;
  const bool clutched = state_.clutched;
  state_ = {};
  state_.tank = tank;
  state_.clutched = clutched;
}

SafetyCore::SafetyCore(const SafetyLimits& limits) : limits_(limits) {
  const auto check = [](const char* what, double value, bool can_be_infinite) {
    if (value >= 0 && (can_be_infinite || std::isfinite(value))) return;
    throw Error(format("safety: {} is {}, it must {}not be negative", what, to_text(value),
                       can_be_infinite ? "" : "be finite and "));
  };
  check("the gain", limits.gain, false);
  check("the force limit", limits.max_force, false);
  check("the slew limit", limits.slew, true);
  check("the ramp's time", limits.ramp_ms, false);
  check("the speed limit", limits.max_speed, true);
  check("the swing of a buzz", limits.buzz_force, true);
  check("the rate of a buzz", limits.buzz_rate, true);
  check("the fade", limits.fade_cells, true);
  check("the watchdog", limits.watchdog_ticks, true);
  check("the reserve", limits.reserve, true);
  check("the hand's acceleration", limits.acceleration, false);
  check("the encoder's step", limits.encoder, false);
  check("the delay", limits.delay_ticks, false);
  if (limits.delay_ticks > kMaxTankDelay)
    throw Error(format("safety: the delay is {} ticks, the limit is {}",
                       to_text(limits.delay_ticks), kMaxTankDelay));
}

}  // namespace hapgrid
