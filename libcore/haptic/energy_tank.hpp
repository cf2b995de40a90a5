// What the hand has put into a device and not got back, and which force that can pay for.
//
// Problem. A force that is right at every place can still give energy to the hand: it comes a tick
// late, it is ramped in while the hand is inside, or it belongs to no energy at all. Choice: the
// tank holds the energy that the hand stored. Before a force is sent, the tank must cover what it
// would cost to let go of that force at the slew limit while the hand runs along with it. So zero
// can always be reached within the slew, and it is paid for. For any sequence of forces, the energy
// returned is at most the sum of: what the tank was granted; kTankSlack; the reserve; what a damper
// of TankTerms::damping takes from the hand on its way, but at most kMostDamped; and for a hand
// that rests kMostLate, also of the half second before, kGift each time that it comes to rest, and
// kRefill from the time on when it holds.
//
// Why the damper. A force that comes late, if only by the half of a tick for which it is held,
// gives back more than it took, on each way to and fro. The tank charges the hand for that, and for
// one more tick. So a spring K that a hand moves would cost it 3/2 K dx^2 in a tick, and the force
// that a trembling hand holds would fade within seconds. But a hand and a device have friction. A
// sampled spring is passive if their damping b is at least K T / 2 (Colgate and Schenkel 1997,
// Passivity of a class of sampled-data systems, J. Robotic Systems 14(1)). So what was charged
// beyond the mean of the forces at both ends of a way is given back, at once as much as the damper
// takes. A hand that goes from place to place could pay with it for snaps that lead up, so that
// kMostDamped bounds it. A hand that rests gets the remainder of the last half second as well: that
// is what a tremble and the way to the contact have cost.
//
// Why the refill. Where a hand comes to a contact, the interpolated energy dips below the lowest
// one of the records, or jumps where corners change. Then the tank has less than the model holds,
// and a hand that trembles there would be weakened for good: it stores less with a weakened force,
// and gets less back. So a hand that comes to rest is given kGift, if its tank has less than half
// of what the model holds, or if its force is weakened. The force comes back to it slowly: within a
// tremble, it would give out on each way out what was filled in. A hand that has rested for 2.5 s
// holds a contact, and gets kRefill until its tank has what it lacks. If its force is still weak,
// it is from then on the part r of the model's that the tank has of the model's energy: such a
// force has the energy r E, and r rises by what is filled in alone. A force that is less by a
// constant has the model's whole stiffness, and a tremble costs it all that is filled in.
// With kRefill after 2 s of rest, up to 0.39 mJ came back in a session of the default hand, and
// with kRefill in the first second after a start as well, 0.55 mJ. In 120,000 sessions with the
// choice made here it was 0.28 mJ, and 0.1 mJ with all grids but one.
//
// The bound holds under these assumptions:
// - The damping of hand and device is at least TankTerms::damping. A hand at rest takes as much as
//   it may be given.
// - The hand's acceleration is at most TankTerms::acceleration.
// - A force is in effect TankTerms::delay or one more ticks after it was sent, for whole ticks.
// - Positions are rounded to TankTerms::encoder, and energy is counted along rounded positions.
// - No tick is missed. A missed tick is charged when it is over, so that later forces pay for it.
//
// Along the true positions each change dF of the force adds at most |dF| times half a step of the
// encoder to the energy, of either sign.
//
// Alternatives: damping that dissipates what an observer counted (it drags, and it breaks the
// slew), a virtual coupling (passive, but softer than the model and drags in free air), scaling the
// whole force (ten times the error).
//
// The forces and places are vectors in the box's axes; places are in metres, energies in joules.
#pragma once

#include <array>
#include <cstdint>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// Joules by which the tank may be overdrawn before forces become softer.
inline constexpr double kTankSlack = 1e-5;
/// The most that counts of what the damping takes, W.
inline constexpr double kMostDamped = 3e-4;
/// The most that a resting hand gets back of what it was charged for late forces, W.
inline constexpr double kMostLate = 3e-3;
/// Joules that a hand is given when it comes to rest, if it lacks them.
inline constexpr double kGift = 3.5e-5;
/// W with which the tank is filled of a hand that holds a contact, if it lacks energy.
inline constexpr double kRefill = 3e-3;
/// The largest TankTerms::delay.
inline constexpr std::uint32_t kMaxTankDelay = 30;

/// What the tank counts on.
struct TankTerms {
  double reserve = 5e-4;     ///< joules that letting go may cost beyond what is stored
  double acceleration = 40;  ///< bound on the hand's, m/s^2
  double encoder = 0;        ///< step of the positions, m
  std::uint32_t delay = 0;   ///< ticks from when a force is sent until it is in effect; or one more
  double damping = 0.1;      ///< of hand and device at least, N s/m; 0: nobody holds the device
  double slew = 1000;        ///< N/s
  double period = 0.001;     ///< seconds from a tick to the next
};

/// What it costs at most, in joules, to let go of a force of so many newtons at the slew limit, a
/// step in each tick, while the hand runs along with it:
///   period * sum over j < ceil(force / step) of
///       (force - j step) max(0, speed + acceleration (j + 1/2) period), step = slew period.
/// In closed form. Infinite when it cannot be computed.
double letgo(double force, double speed, const TankTerms& terms) noexcept;

/// For one thread; real-time safe. In each tick: move(), then perhaps refill(), then soften() and
/// bound() if a force is to be sent, then sent().
class EnergyTank {
 public:
  /// In this tick the part of the force that the ramp lets through rises from `before` to `after`,
  /// both in [0, 1]; a ramp begins with `before` = 0. Grants what `after` times the model's energy
  /// gains by that, and otherwise what the tank lacks of it, until all grants together are what the
  /// tank lacked where the ramp began (safety.hpp).
  /// @param held joules that the model holds above its lowest energy
  void ramp(double before, double after, double held) noexcept;
  /// Whether the hand has rested for a quarter of a second, trembling by 3 mm at most.
  bool rests() const noexcept;
  /// Gives back and fills in what the tank lacks, if the hand rests and there is damping. Says
  /// which part of its force a hand gets that holds a weakened one.
  /// @param dt seconds since it was done before.
  /// @param held joules that the model holds above its lowest energy
  void refill(const TankTerms& terms, double held, double dt) noexcept;
  double energy() const noexcept { return energy_; }
  /// Joules that were granted so far.
  double granted() const noexcept { return granted_; }

  /// The hand came to `place`; charges what the force has done.
  /// @param dt seconds since the move before. @param certain false when ticks were missed, so that
  /// nobody knows which force was in effect in between: then nothing is gained.
  void move(const TankTerms& terms, const Vec3& place, double dt, bool certain) noexcept;
  /// Nobody knows where the hand is. The next move() is uncertain, and its speed is not known.
  void lose_sight() noexcept { seen_ = 0, rested_ = 0; }
  /// The handle will move unseen, and the force goes to zero: charges what that may cost.
  void let_go_unseen(const TankTerms& terms) noexcept;

  /// `wanted`, made smaller along the hand's motion where the tank cannot pay for it. What was
  /// taken away comes back slowly, so that the force does not flicker.
  Vec3 soften(const TankTerms& terms, const Vec3& wanted, double dt) noexcept;
  /// `wanted` if the tank can pay for it; else a force between it and the last one made shorter.
  /// @param before the last force. @param step the slew limit of this tick in newtons.
  Vec3 bound(const TankTerms& terms, const Vec3& wanted, const Vec3& before,
             double step) const noexcept;
  void sent(const Vec3& force) noexcept;

 private:
  const Vec3& force(std::uint32_t ticks_ago) const noexcept;
  double cost(const TankTerms& terms, const Vec3& force) const noexcept;
  double under_way(const TankTerms& terms) const noexcept;
  double speed_along(const TankTerms& terms, const Vec3& force, double length) const noexcept;
  void measure_speed() noexcept;

  double energy_ = 0;
  double granted_ = 0;
  double ramp_left_ = 0;  // what this ramp may still grant beyond its rise
  Vec3 withheld_{0, 0, 0};
  double part_ = 1;  // of the wanted force, that a hand gets which holds a weakened one
  // Of the last move: what sent() may give back.
  Vec3 way_{0, 0, 0};
  double charged_ = 0;
  double damped_ = 0;
  double most_late_ = 0;
  double late_ = 0;   // what was charged lately beyond the mean and not given back
  double given_ = 0;  // of kGift, in this rest
  Vec3 place_{0, 0, 0};
  bool placed_ = false;
  // The mean of the last places, and for how many seconds the hand has been near it.
  Vec3 rest_{0, 0, 0};
  double rested_ = 0;
  // The last places, a ring: enough for the window at 30 kHz.
  static constexpr std::uint32_t kSeen = 64;
  std::array<Vec3, kSeen> places_{};
  std::array<double, kSeen> times_{};
  double time_ = 0;
  std::uint32_t newest_ = 0;
  std::uint32_t oldest_ = 0;  // of the window
  std::uint32_t seen_ = 0;    // places in the window
  Vec3 speed_{0, 0, 0};       // mean over the window
  double window_ = 0;         // seconds; 0: the speed is not known
  // The last forces, a ring.
  static constexpr std::uint32_t kForces = 32;
  static_assert(kForces >= kMaxTankDelay + 2);
  std::array<Vec3, kForces> forces_{};
  std::uint32_t last_force_ = 0;
};

}  // namespace hapgrid
