// The safety core: the one thing between a computed force and the hand.
//
// Every force goes through limit_force() before a device gets it, whatever computed it. The
// function depends only on the input, the limits, and a small state of its own. It keeps three
// promises, the first two for every sequence of inputs, hostile ones included:
//
//   |F| <= limits.max_force, always;
//   |F - F of the tick before| <= slew min(dt, slew_dt), unless F is a zero that a fault demands:
//   so the loop keeps the slew limit in wall time (loop.hpp);
//   energy that the hand got back <= what it has put in + what the ramp granted
//   + 2 mW for the time in which it holds a weakened force + limits.reserve + 0.03 mJ.
//
// What the third promise assumes: the hand's acceleration, the encoder and the delay are those of
// the limits, and no tick is missed; forces that do what the model's energy loses come late by what
// the damping of hand and device takes. A field does so: its forces change little in a tick. That
// the energies and forces of a grid belong to one field is guarded by record_fields.hpp when it is
// loaded, and by the tank where they differ in a tick (energy_tank.hpp). The promise needs the
// hand's place in metres, so there is none where the scale is not known: that is so only for
// devices that push nobody (paths, keys, and replays of them).
//
// The ramp. A force that rises from 0 to F where the hand is gives the hand energy that it never
// put in: without that energy a contact that is there at the start would stay without its force for
// as long as it is held. In a tick in which the ramp rises by dr, a model that holds the energy E
// there grants dr E, which is what r E(x) gains, unless the tank has r E already. A fault without a
// ramp grants nothing anew.
//
// Faults are a number that is not finite, a silent device, a hand that is too fast, missed ticks,
// and buzzing that does not stop. A fault gives zero in the very tick in which it is seen, without
// a ramp. Afterwards the force comes back with a ramp; after a number that was not finite, which
// means that something is broken, only once reset() was called.
//
// The order. What scales the wanted force comes first (gain, fade, damping, ramp), so that the slew
// limit sees everything that could step. The clamp comes after it: the projection to a ball never
// moves two points apart, so it keeps the slew. The other order, or a clamp per axis (which also
// turns the force), would break a promise. The energy is looked at twice: before the slew limit the
// force is made smaller where the tank runs low; at the end it is held between the wanted force and
// the last one made shorter, which both keep the other promises. A snap is not blended over: the
// slew limit is enough, and a blend gives energy back.
//
// Alternatives: limits in each device (the next device would forget them); limits in the model (a
// plug-in cannot be trusted).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "libcore/grid/box.hpp"
#include "libcore/loop/energy_tank.hpp"

namespace hapgrid {

/// The limit of each stage, for a small desktop device of about 3 N. The user of play can change
/// gain, max_force, ramp_ms, reserve, encoder and delay_ticks, which differ between devices and
/// models. The others are the same for all, and only tests change them.
struct SafetyLimits {
  double gain = 1;       ///< newtons felt for a newton of the model
  double max_force = 3;  ///< newtons, of the magnitude
  /// Newtons a millisecond, of the vector's change; inf: none. The full force may still come within
  /// 3 ms, which feels like a wall; a larger step is a blow that makes a device ring.
  double slew = 1;
  double ramp_ms = 500;  ///< from zero to the full force, at the start and after a fault
  /// Of the hand, m/s; a faster hand gets zero force; inf: none. A hand that feels its way moves at
  /// a tenth of that: a faster handle was let go of, or is thrown by the force.
  double max_speed = 2;
  /// Newtons: a swing of the force this large counts as one; inf: none. Smaller ones do not hurt.
  double buzz_force = 0.5;
  /// Swings a second; with more the force is damped, see kBuzzStop. No hand turns back that often
  /// on purpose: the loop of device and model does it.
  double buzz_rate = 30;
  /// Outside the box the force fades to zero over so many cells; 0: none. Nothing is known there,
  /// and a force that ended at the border would be a step.
  double fade_cells = 1;
  /// This many missed ticks give zero, then a ramp; inf: none. At 1 kHz 10 ms: a busy machine is
  /// seldom late by that, and a hand goes 2 cm in them at most.
  double watchdog_ticks = 10;
  double reserve = 0.5;      ///< mJ that letting go may cost beyond the tank's; inf: no limit
  double acceleration = 40;  ///< of the hand at most, m/s^2
  double encoder = 5.5e-5;   ///< the device's positions come in such steps, m
  double delay_ticks = 0;    ///< from when a force is sent until it is in effect
};

/// At this multiple of buzz_rate damping did not help, and the force becomes zero.
inline constexpr double kBuzzStop = 2;

/// What the loop knows at a tick.
struct SafetyInput {
  Vec3 force{0, 0, 0};  ///< newtons, as the model gave it
  double dt = 0.001;    ///< seconds since the tick before; > 0
  /// Seconds since the last force was sent, for which the slew limit lets the force change; more
  /// than dt counts as dt.
  double slew_dt = std::numeric_limits<double>::infinity();
  std::uint64_t missed = 0;  ///< ticks that were missed in between
  double speed = 0;          ///< of the hand, m/s; 0 when the scale is not known
  /// The HIP in metres of the hand, in the box's axes; nothing when the scale is not known.
  std::optional<Vec3> place = std::nullopt;
  /// Joules that the model holds there, above its lowest energy, where that is known.
  std::optional<double> model_energy = std::nullopt;
  /// Joules that lose in a tick what the model's force does in it, unless something jumped:
  /// NodeForce::account(). Nothing where the model's energy is not known.
  std::optional<double> account = std::nullopt;
  /// The state does not go on from that of the tick before.
  bool jumped = false;
  /// The hand chose this state, and did not come to it: the force comes in by the ramp.
  bool chosen = false;
  double outside_cells = 0;  ///< how far the HIP is outside the box, in grid spacings
  bool stalled = false;      ///< the device is silent, so nobody knows where the hand is
  bool clutch = false;       ///< the hand moves without the HIP and must feel nothing
  bool unusable = false;     ///< the state is not that of the HIP: a fault
};

/// What acted in a tick, as bits of SafeForce::acted.
enum SafetyAction : std::uint32_t {
  kFault = 1U << 0,     ///< zero until reset(): something was not finite, or unusable
  kStalled = 1U << 1,   ///< zero: the device was silent
  kMissed = 1U << 2,    ///< zero: too many ticks were missed
  kTooFast = 1U << 3,   ///< zero: the hand was too fast
  kBuzzing = 1U << 4,   ///< zero: damping did not stop the buzz
  kClutched = 1U << 5,  ///< on the way to zero: the clutch is held
  kDamped = 1U << 6,    ///< the buzz detector made the force smaller
  kFaded = 1U << 7,     ///< outside the box
  kRamped = 1U << 8,    ///< on the way back from zero
  kSlewed = 1U << 9,    ///< the change was above the limit
  kClamped = 1U << 10,  ///< the magnitude was above the limit
  kEnergy = 1U << 11,   ///< the hand would have got back more than it may
};
inline constexpr std::size_t kSafetyActions = 12;
/// The names of the bits in logs and reports.
inline constexpr std::array<const char*, kSafetyActions> kSafetyNames{
    "fault",  "stalled", "missed", "too-fast", "buzzing", "clutch",
    "damped", "faded",   "ramped", "slewed",   "clamped", "energy"};
/// The actions that give zero at once.
inline constexpr std::uint32_t kSafetyZero = kFault | kStalled | kMissed | kTooFast | kBuzzing;

struct SafeForce {
  Vec3 force{0, 0, 0};      ///< newtons, to be sent
  std::uint32_t acted = 0;  ///< SafetyAction
};

/// What limit_force() remembers from tick to tick.
struct SafetyState {
  Vec3 sent{0, 0, 0};  // the force of the tick before
  bool faulted = false;
  double ramp = 0;  // in [0, 1]
  // Velocity guard.
  double speed = 0;  // m/s, smoothed
  bool too_fast = false;
  // Buzz: turning points of the wanted force.
  Vec3 anchor{0, 0, 0};   // the last turning point
  Vec3 extreme{0, 0, 0};  // the force that was farthest from it since
  double swings = 0;      // a leaky count: swings a second times the time constant
  bool buzzing = false;
  // Energy.
  EnergyTank tank;
  std::optional<double> account;  // of the tick before
  bool clutched = false;
};

/// The force to send for `input`. Real-time safe; pure: equal arguments give equal results.
SafeForce limit_force(const SafetyLimits& limits, SafetyState& state,
                      const SafetyInput& input) noexcept;

/// Limits and state together, for one thread.
class SafetyCore {
 public:
  /// @throw Error when a limit is negative or not a number, or max_force or gain is infinite.
  explicit SafetyCore(const SafetyLimits& limits = {});

  /// Real-time safe.
  SafeForce apply(const SafetyInput& input) noexcept { return limit_force(limits_, state_, input); }
  bool faulted() const noexcept { return state_.faulted; }
  /// Another hand: nothing of the ticks before counts. Real-time safe.
  void begin() noexcept { state_ = {}; }
  /// Ends a fault: the force comes back with the ramp. Real-time safe.
  void reset() noexcept;
  /// Joules that the ramp has added so far to what the hand may get back. Real-time safe.
  double granted() const noexcept { return state_.tank.granted(); }
  /// Joules that the hand may get back. Real-time safe.
  double tank_energy() const noexcept { return state_.tank.energy(); }

 private:
  SafetyLimits limits_;
  SafetyState state_;
};

}  // namespace hapgrid
