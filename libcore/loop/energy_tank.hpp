// What a hand has put into a device and not got back, and which force that can pay for.
//
// The principle. A force that is the gradient of an energy gives back on a way what it took. It
// gives more only because it is late: a spring K that holds for a tick T gives a hand with the
// speed v K T / 2 v^2 watts more, so a damping of K T / 2 makes it passive (Colgate and Schenkel
// 1997, Passivity of a class of sampled-data systems, J. Robotic Systems 14(1)). The device itself
// supplies that damping, and the tank books what the model's energy loses. So on a branch the tank
// has the model's energy: a tremble costs nothing, and a contact holds. Four rules follow.
// - Lead. A force acts within the d + 2 ticks after it was sent, d = TankTerms::delay. Its change
//   in d + 1 ticks is added, half of that in the last 2 (d + 1) (a step of the encoder swings it by
//   half more), but only what is along the motion and against it: nothing else takes energy.
// - Booking. On a way the device has done the larger work of the two forces that may be in effect.
//   If the energy lost on it is known, it is compared with the mean of the forces at both ends,
//   which do the same work to third order. Then the mean is booked, and by how much they differ.
// - Paying. Before a force is sent, the tank must cover what it would cost to let go of it at the
//   slew limit while the hand runs along. So zero can always be reached, and it is paid for.
// - Refill. The interpolated energy jumps where corners change, and a hand that came over a jump
//   may lack it. While its force is weak and it holds, kRefill is added, up to the model's energy,
//   unless its forces have done more than the energy says.
//
// For any sequence of forces, the energy returned is at most the sum of: what was granted;
// kTankSlack; the reserve; kRefill while a weak force is held; and what forces that the model's
// energy explains give beyond their mean, since they are later than the lead makes up for. The last
// is left to the damping of hand and device. The bound holds if the hand's acceleration is that of
// the terms at most, and if a force is in effect from d or d + 1 ticks on, for whole ticks. Energy
// is counted along rounded positions; true ones add |dF| half an encoder's step for a change dF.
//
// Alternatives: to book the larger work always (what a trembling hand holds fades) or the mean
// always (4 to 6 mJ for forces of no energy); a damper for what was counted (it breaks the slew).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// Joules by which the tank may be overdrawn before forces become softer: energies dip by up to
/// 0.04 mJ between records. Leu-enkephalin (30 points a side) chose it: with 0.05 mJ half as many
/// of its contacts fade, and 0.19 mJ come back instead of 0.15.
inline constexpr double kTankSlack = 3e-5;
/// A hand holds that drifts by less m/s; a faster one that circles over a jump would be paid each
/// time (dichloroethane). It gets so many watts, what 4 N s/m take of a tremble of 0.3 mm at 10 Hz.
inline constexpr double kHolding = 0.01, kRefill = 2e-3;
/// Joules that the mean of the forces may have done beyond what the model's energy lost; then
/// nothing is refilled. A hand that rests where forces have no energy, in a torn cell, would get
/// back kRefill for as long as it rests.
inline constexpr double kMostRefill = 1e-4;
/// The largest part by which the lead weakens a force; a hand notices 5 to 10 % (Pang, Tan and
/// Durlach 1991). On the way in it is not limited, which alone is enough where the delay is 0.
inline constexpr double kMostLead = 0.05;
/// The largest TankTerms::delay.
inline constexpr std::uint32_t kMaxTankDelay = 30;

/// What the tank counts on.
struct TankTerms {
  double reserve = 5e-4;     ///< joules that letting go may cost beyond what is in the tank
  double acceleration = 40;  ///< bound on the hand's, m/s^2
  double encoder = 0;        ///< step of the positions, m
  std::uint32_t delay = 0;   ///< ticks from when a force is sent until it is in effect; or one more
  double slew = 1000;        ///< N/s
  double period = 0.001;     ///< seconds from a tick to the next
};

/// What it costs at most, in joules, to let go of a force of so many newtons at the slew limit, a
/// step in each tick, while the hand runs along with it:
///   period * sum over j < ceil(force / step) of
///       (force - j step) max(0, speed + acceleration (j + 1/2) period), step = slew period.
/// In closed form. Infinite when it cannot be computed.
double letgo(double force, double speed, const TankTerms& terms) noexcept;

/// For one thread; real-time safe; places in m. In each tick: move(), then perhaps ramp() or
/// refill(), then lead(), soften() and bound() if a force is to be sent, then sent().
class EnergyTank {
 public:
  /// The part of the force that the ramp lets through rises from `before` to `after`, in [0, 1].
  /// Grants what the tank lacks of `after` times the model's energy, at most what the ramp adds.
  /// @param model_energy J above the model's lowest
  void ramp(double before, double after, double model_energy) noexcept;
  /// While a weak force is held, adds what the tank lacks of the model's energy. @param dt s
  void refill(double model_energy, double dt) noexcept;
  double energy() const noexcept { return energy_; }
  double granted() const noexcept { return granted_; }  ///< so far

  /// The hand came to `place`; charges what the force has done. @param dt seconds since the last
  /// move. @param certain false when ticks were missed: nobody knows which forces were in effect.
  /// Then nothing is gained, and later forces pay for what was lost.
  void move(const TankTerms& terms, const Vec3& place, double dt, bool certain) noexcept;
  /// Nobody knows where the hand is. The next move() is uncertain, and its speed is not known.
  void lose_sight() noexcept { seen_ = 0; }
  /// The handle will move unseen while the force goes to zero: charges what that may cost.
  void let_go_unseen(const TankTerms& terms) noexcept;

  /// What is to be added to `force` since it is late. @param goes_on from the forces before
  Vec3 lead(const TankTerms& terms, const Vec3& force, bool goes_on) noexcept;
  /// `wanted`, made smaller along the hand's motion where the tank cannot pay for it. What was
  /// taken away comes back slowly, so that the force does not flicker.
  Vec3 soften(const TankTerms& terms, const Vec3& wanted, double dt) noexcept;
  /// `wanted` if the tank can pay for it; else a force between it and the last one made shorter.
  /// @param before the last force. @param change the slew limit of this tick in newtons.
  Vec3 bound(const TankTerms& terms, const Vec3& wanted, const Vec3& before,
             double change) const noexcept;
  /// @param lost J that the model's energy lost on the last way; nothing: it jumped, or is unknown
  void sent(const Vec3& force, std::optional<double> lost) noexcept;

 private:
  const Vec3& force(std::uint32_t ago) const noexcept {
    return forces_[(last_force_ + kForces - ago) % kForces];
  }
  double cost(const TankTerms& terms, const Vec3& force) const noexcept;
  double under_way(const TankTerms& terms) const noexcept;
  double speed_along(const TankTerms& terms, const Vec3& force, double length) const noexcept;

  double energy_ = 0, granted_ = 0;
  Vec3 withheld_{0, 0, 0};
  Vec3 lead_{0, 0, 0}, plain_{0, 0, 0};  // lead of this tick; the last force without its lead
  std::optional<Vec3> place_;
  Vec3 way_{0, 0, 0};       // of the last move
  double charged_ = 0;      // for it
  double unexplained_ = 0;  // J that the mean of the forces did beyond the model's energy
  // The last places, and when: enough for the window at 30 kHz.
  static constexpr std::uint32_t kPlaces = 64;
  std::array<std::pair<Vec3, double>, kPlaces> places_{};
  double time_ = 0;
  std::uint32_t newest_ = 0, seen_ = 0;  // of them
  Vec3 speed_{0, 0, 0};                  // mean over the window, m/s
  Vec3 drift_{0, 0, 0};                  // over a tremble, m/s
  double window_ = 0;                    // seconds; 0: the speed is not known
  // The last forces, as they were sent and as they were wanted.
  static constexpr std::uint32_t kForces = 64;
  static_assert(kForces > 2 * (kMaxTankDelay + 1));
  std::array<Vec3, kForces> forces_{}, wanted_{};
  std::uint32_t last_force_ = 0, known_ = 0;  // wanted ones since one that did not go on
};

}  // namespace hapgrid
