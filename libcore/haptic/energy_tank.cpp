#include "libcore/haptic/energy_tank.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// Seconds over which the hand's speed is measured: shorter, and an encoder's step looks fast.
constexpr double kWindow = 0.002;
// Seconds in which a force that was withheld comes back.
constexpr double kRestReturn = 0.7;    // to a hand that rests, while the tank is filled
constexpr double kFilledReturn = 0.1;  // to such a hand, when the tank is full
constexpr double kSlowReturn = 0.3;    // to a hand that moves, while the tank is overdrawn
constexpr double kReturn = 0.03;       // in all other cases
// A hand rests that has been for kRestTime (s) within kRestRadius (m) of the mean of its places
// over kRestMean (s), which is about a period of its tremor.
constexpr double kRestTime = 0.25;
constexpr double kRestRadius = 3e-3;
constexpr double kRestMean = 0.1;
constexpr double kHoldTime = 2.5;  // seconds of rest after which the hand holds
// Seconds after which what was charged for late forces is forgotten: a way to a contact takes about
// as long.
constexpr double kLateTime = 0.5;
// Joules. The tank of a resting hand is filled up to half of what the model holds, but at least up
// to this, if the model holds as much: a tremble takes a part of it out and brings it back.
constexpr double kLow = 5e-5;
// Joules above what the model holds, up to which the tank is filled when it had too little: the
// model holds less than nothing where its interpolated energy dips below the lowest one of the
// records.
constexpr double kAbove = 5e-5;
// Newtons: less is not withheld at all, so that withholding ends.
constexpr double kNothing = 1e-6;
// The part of the way to the wanted force is found to 2^-20.
constexpr int kHalvings = 20;

/// The force that costs `joules` to let go of at this speed without acceleration: letgo()
/// backwards. With n steps it is linear, period speed (n force - step n (n - 1) / 2).
double affordable(double joules, double speed, const TankTerms& terms) {
  const double sum = joules / (terms.period * speed);  // newtons, over all ticks
  const double step = terms.slew * terms.period;
  if (!(step < kUnbounded)) return sum;
  const double n = std::max(1.0, std::ceil((std::sqrt(1 + 8 * sum / step) - 1) / 2));
  return sum / n + step * (n - 1) / 2;
}

/// By how much rounded positions can count more work than true ones while a force goes to zero, or
/// in one tick: both ends of the way are off by half a step on each axis.
double rounding(const TankTerms& terms, const Vec3& force) {
  return (std::abs(force[0]) + std::abs(force[1]) + std::abs(force[2])) * terms.encoder;
}

}  // namespace

double letgo(double force, double speed, const TankTerms& terms) noexcept {
  const double dt = terms.period;
  const double step = terms.slew * dt;
  const double gain = terms.acceleration * dt;  // of speed in a tick
  const double first = speed + gain / 2;
  if (force == 0) return 0;
  if (force <= step) return dt * force * std::max(0.0, first);
  const double n = std::ceil(force / step);
  double begin = 0;  // ticks before it run against the force
  if (first < 0) {
    if (!(gain > 0)) return 0;
    begin = std::ceil(-first / gain);
    if (begin >= n) return 0;
  }
  const double count = n - begin;
  const double sum = count * (begin + n - 1) / 2;  // of j, and of its square
  const double squares = ((n - 1) * n * (2 * n - 1) - (begin - 1) * begin * (2 * begin - 1)) / 6;
  const double all =
      force * first * count + (force * gain - step * first) * sum - step * gain * squares;
  return std::isfinite(all) ? std::max(0.0, dt * all) : kUnbounded;
}

const Vec3& EnergyTank::force(std::uint32_t ticks_ago) const noexcept {
  return forces_[(last_force_ + kForces - ticks_ago) % kForces];
}

void EnergyTank::move(const TankTerms& terms, const Vec3& place, double dt, bool certain) noexcept {
  if (placed_) {
    const Vec3 way = place - place_;
    double work = std::max(dot(force(terms.delay), way), dot(force(terms.delay + 1), way));
    const bool sure = certain && seen_ > 0;
    if (!sure) work = std::max(work, 0.0);
    energy_ -= work;
    way_ = way;
    charged_ = work;
    damped_ = sure ? std::min(terms.damping * dot(way, way) / dt, kMostDamped * dt) : 0;
    most_late_ = sure ? kMostLate * dt : 0;
    // A sum that cannot be computed stands for a tank that is empty for good.
    if (!std::isfinite(energy_)) energy_ = std::numeric_limits<double>::lowest();
  }
  place_ = place;
  placed_ = true;
  part_ = 1;
  late_ *= kLateTime / (kLateTime + dt);
  if (rested_ == 0) {
    rest_ = place;
    given_ = 0;
  }
  rest_ = rest_ + dt / (kRestMean + dt) * (place - rest_);
  rested_ = length_of(place - rest_) <= kRestRadius ? rested_ + dt : 0;

  time_ += dt;
  newest_ = (newest_ + 1) % kSeen;
  places_[newest_] = place;
  times_[newest_] = time_;
  if (seen_ == 0) oldest_ = newest_;
  if (seen_ == kSeen) {
    oldest_ = (oldest_ + 1) % kSeen;
  } else {
    ++seen_;
  }
  measure_speed();
}

void EnergyTank::measure_speed() noexcept {
  // The window is the shortest one that is not below kWindow.
  while (seen_ > 2) {
    const std::uint32_t next = (oldest_ + 1) % kSeen;
    if (time_ - times_[next] < kWindow * (1 - 1e-9)) break;
    oldest_ = next;
    --seen_;
  }
  window_ = time_ - times_[oldest_];
  if (!(window_ > 0)) {
    window_ = 0;
    speed_ = {0, 0, 0};
    return;
  }
  const Vec3 way = places_[newest_] - places_[oldest_];
  speed_ = {way[0] / window_, way[1] / window_, way[2] / window_};
}

/// A bound on the hand's speed along a force.
double EnergyTank::speed_along(const TankTerms& terms, const Vec3& force,
                               double length) const noexcept {
  if (window_ == 0) return kUnbounded;
  const double error = rounding(terms, force) / length / window_;
  const double speed = dot(force, speed_) / length + error + terms.acceleration * window_ / 2;
  return speed < kUnbounded ? speed : kUnbounded;  // also where it is not a number
}

/// What the forces that were sent and are not yet over can do.
double EnergyTank::under_way(const TankTerms& terms) const noexcept {
  double all = 0;
  for (std::uint32_t j = 0; j <= terms.delay; ++j) {
    const Vec3& f = force(terms.delay - j);
    const double size = length_of(f);
    if (size == 0) continue;
    const double speed =
        speed_along(terms, f, size) + terms.acceleration * (j + 0.5) * terms.period;
    all += size * terms.period * std::max(0.0, speed) + rounding(terms, f);
  }
  return all;
}

double EnergyTank::cost(const TankTerms& terms, const Vec3& force) const noexcept {
  const double size = length_of(force);
  if (size == 0) return 0;
  const double speed =
      speed_along(terms, force, size) + terms.acceleration * (terms.delay + 1) * terms.period;
  return letgo(size, speed, terms) + rounding(terms, force);
}

void EnergyTank::let_go_unseen(const TankTerms& terms) noexcept {
  if (seen_ == 0) return;
  const double all = cost(terms, force(0)) + under_way(terms);
  energy_ = all < kUnbounded ? energy_ - all : std::numeric_limits<double>::lowest();
  lose_sight();
}

Vec3 EnergyTank::soften(const TankTerms& terms, const Vec3& wanted, double dt) noexcept {
  Vec3 force = wanted;
  const double affords = energy_ + kTankSlack;
  const double time = rests() ? kRestReturn : affords < 0 ? kSlowReturn : kReturn;
  for (double& w : withheld_) w *= time / (time + dt);
  if (part_ < 1) withheld_ = (1 - part_) * wanted;
  if (const double kept = length_of(withheld_); kept > kNothing) {
    const double along = dot(force, withheld_) / kept;
    force = force + -std::min(kept, std::max(0.0, along)) / kept * withheld_;
  }
  if (const double speed = length_of(speed_); speed > 0 && speed < kUnbounded) {
    const double along = dot(force, speed_) / speed;
    TankTerms steady = terms;
    steady.acceleration = 0;
    if (along > 0 && letgo(along, speed, steady) > std::max(0.0, affords))
      force = force + (std::min(along, affordable(std::max(0.0, affords), speed, terms)) - along) /
                          speed * speed_;
  }
  withheld_ = wanted - force;
  return force;
}

Vec3 EnergyTank::bound(const TankTerms& terms, const Vec3& wanted, const Vec3& before,
                       double step) const noexcept {
  const double rest = std::max(0.0, energy_ + kTankSlack + terms.reserve) - under_way(terms);
  if (cost(terms, wanted) <= rest) return wanted;
  const double size = length_of(before);
  const Vec3 shorter = size > step ? before + -step / size * before : Vec3{0, 0, 0};
  const Vec3 way = wanted - shorter;
  double part = 0;
  for (double half = 0.5; half > std::ldexp(1.0, -kHalvings - 1); half /= 2)
    if (cost(terms, shorter + (part + half) * way) <= rest) part += half;
  return shorter + part * way;
}

void EnergyTank::ramp(double before, double after, double held) noexcept {
  if (before == 0) ramp_left_ = held - std::max(0.0, energy_);
  const auto grant = [&](double joules, double most) {
    const double more = std::min(joules, most - energy_);
    if (!(more > 0)) return;  // also where one of them is not a number
    energy_ += more;
    granted_ += more;
    ramp_left_ -= more;
  };
  grant((after - before) * held, after * held);
  grant(ramp_left_, after * (held + kAbove));
}

bool EnergyTank::rests() const noexcept { return rested_ >= kRestTime; }

void EnergyTank::refill(const TankTerms& terms, double held, double dt) noexcept {
  if (!rests() || terms.damping == 0) return;
  const bool is_weak = energy_ < 0 || length_of(withheld_) > kNothing;
  // What is not a number adds nothing.
  const double all = std::max(0.0, held), above = all + kAbove;
  const auto fill = [&](double wanted, double most) {
    const double more = std::clamp(wanted - energy_, 0.0, std::max(0.0, most));
    energy_ += more;
    return more;
  };
  late_ -= fill(above, late_);
  const double wanted = is_weak ? above : std::max(all / 2, std::min(all, kLow));
  if (rested_ < kHoldTime) {
    given_ += fill(wanted, kGift - given_);
  } else {
    fill(wanted, kRefill * dt);
    if (is_weak) part_ = std::clamp(energy_ / (all + kAbove / 2), 0.0, 1.0);
  }
  const double lacks = above - energy_;
  if (is_weak && lacks < kAbove / 2)
    for (double& w : withheld_) w *= kFilledReturn / (kFilledReturn + dt);
}

void EnergyTank::sent(const Vec3& force) noexcept {
  const double mean = dot(0.5 * (forces_[last_force_] + force), way_);
  // What is not a number gives nothing back.
  if (const double late = charged_ - mean; late > 0) {
    const double now = std::min(late, damped_);
    energy_ += now;
    late_ += std::max(0.0, std::min(late, most_late_) - now);
  }
  damped_ = most_late_ = 0;
  last_force_ = (last_force_ + 1) % kForces;
  forces_[last_force_] = force;
}

}  // namespace hapgrid
