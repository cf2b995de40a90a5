#include "libcore/loop/energy_tank.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcore/grid/vec3.hpp"

namespace hapgrid {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kWindow = 0.002;  // seconds for the speed: in a tick, an encoder's step looks fast
// Seconds in which a force that was withheld comes back. A third or three times of it do as well.
constexpr double kReturn = 0.03;
constexpr double kTremor = 0.1;    // seconds: about a period of a hand's tremor
constexpr double kNothing = 1e-6;  // newtons: less is not withheld, so that withholding ends

/// The part of a way, in [0, 1), up to which it is affordable, to 2^-20.
template <class Costs>
double affordable_part(double joules, const Costs& costs) {
  double part = 0;
  for (double half = 0.5; half >= 0x1p-20; half /= 2)
    if (costs(part + half) <= joules) part += half;
  return part;
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

void EnergyTank::move(const TankTerms& terms, const Vec3& place, double dt, bool certain) noexcept {
  if (place_) {
    const bool sure = certain && seen_ > 0;
    const Vec3 way = place - *place_;
    double work = std::max(dot(force(terms.delay), way), dot(force(terms.delay + 1), way));
    if (!sure) work = std::max(work, 0.0);
    energy_ -= work;
    way_ = sure ? way : Vec3{0, 0, 0};
    charged_ = sure ? work : 0;
    // A sum that cannot be computed stands for a tank that is empty for good.
    if (!std::isfinite(energy_)) energy_ = std::numeric_limits<double>::lowest();
  }
  place_ = place;
  time_ += dt;
  newest_ = (newest_ + 1) % kPlaces;
  places_[newest_] = {place, time_};
  seen_ = std::min(seen_ + 1, kPlaces);
  // The speed is that over the shortest window that is not below kWindow.
  speed_ = {0, 0, 0};
  window_ = 0;
  for (std::uint32_t ago = 1; ago < seen_ && !(window_ >= kWindow * (1 - 1e-9)); ++ago) {
    const auto& [from, then] = places_[(newest_ + kPlaces - ago) % kPlaces];
    window_ = time_ - then;
    if (window_ > 0) speed_ = 1 / window_ * (place - from);
  }
  if (window_ > 0) drift_ = drift_ + dt / (kTremor + dt) * (speed_ - drift_);
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

Vec3 EnergyTank::lead(const TankTerms& terms, const Vec3& force, bool goes_on) noexcept {
  const std::uint32_t now = (last_force_ + 1) % kForces;  // of sent()
  wanted_[now] = force;
  if (!goes_on || window_ == 0) known_ = 0;
  const std::uint32_t ticks = std::min(known_, 2 * (terms.delay + 1));
  known_ = std::min(known_ + 1, kForces - 1);
  const Vec3 change = force - wanted_[(now + kForces - ticks) % kForces];
  const double along = dot(change, speed_), square = dot(speed_, speed_);
  if (!(along < 0 && square < kUnbounded)) return lead_ = {0, 0, 0};
  lead_ = (terms.delay + 1.0) / ticks * along / square * speed_;
  const double most = kMostLead * length_of(force), size = length_of(lead_);
  if (size > most && dot(lead_, force) < 0) lead_ = most / size * lead_;
  return lead_;
}

Vec3 EnergyTank::soften(const TankTerms& terms, const Vec3& wanted, double dt) noexcept {
  Vec3 force = wanted;
  for (double& w : withheld_) w *= kReturn / (kReturn + dt);
  if (const double kept = length_of(withheld_); kept > kNothing) {
    const double along = dot(force, withheld_) / kept;
    force = force + -std::min(kept, std::max(0.0, along)) / kept * withheld_;
  }
  if (const double speed = length_of(speed_); speed > 0 && speed < kUnbounded) {
    const double along = dot(force, speed_) / speed, joules = std::max(0.0, energy_ + kTankSlack);
    TankTerms steady = terms;
    steady.acceleration = 0;
    const auto costs = [&](double part) { return letgo(part * along, speed, steady); };
    if (along > 0 && costs(1) > joules)
      force = force + (affordable_part(joules, costs) - 1) * along / speed * speed_;
  }
  withheld_ = wanted - force;
  return force;
}

Vec3 EnergyTank::bound(const TankTerms& terms, const Vec3& wanted, const Vec3& before,
                       double change) const noexcept {
  const double rest = std::max(0.0, energy_ + kTankSlack + terms.reserve) - under_way(terms);
  if (cost(terms, wanted) <= rest) return wanted;
  const double size = length_of(before);
  const Vec3 shorter = size > change ? before + -change / size * before : Vec3{0, 0, 0};
  const Vec3 way = wanted - shorter;
  const auto costs = [&](double part) { return cost(terms, shorter + part * way); };
  return shorter + affordable_part(rest, costs) * way;
}

void EnergyTank::ramp(double before, double after, double model_energy) noexcept {
  const double more = std::min(after * model_energy - energy_, (after - before) * model_energy);
  if (!(more > 0)) return;  // also where it is not a number
  energy_ += more;
  granted_ += more;
}

void EnergyTank::refill(double model_energy, double dt) noexcept {
  const bool is_weak = energy_ < 0 || length_of(withheld_) > 0;
  const double more = std::min(model_energy - energy_, kRefill * dt);
  if (is_weak && length_of(drift_) <= kHolding && more > 0 && unexplained_ < kMostRefill)
    energy_ += more;
}

void EnergyTank::sent(const Vec3& force, std::optional<double> lost) noexcept {
  const Vec3 plain = force - lead_;
  const double mean = dot(0.5 * (plain_ + plain), way_);
  if (lost && std::isfinite(mean - *lost)) unexplained_ += mean - *lost;
  // What is not a number gives nothing back.
  if (const double more = lost ? charged_ - mean - std::abs(mean - *lost) : 0; more > 0)
    energy_ += more;
  way_ = lead_ = {0, 0, 0};
  charged_ = 0;
  plain_ = plain;
  last_force_ = (last_force_ + 1) % kForces;
  forces_[last_force_] = force;
}

}  // namespace hapgrid
