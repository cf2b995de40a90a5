#include "tests/bench/simulated.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libcore/base/random.hpp"

namespace hapgrid {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

/// The exponential by its series, of a part so small that the series ends soon, squared as often as
/// needed.
Matrix exponential(Matrix a) {
  double largest = 0;
  for (const auto& row : a)
    for (const double entry : row) largest = std::max(largest, std::abs(entry));
  int squarings = 0;
  for (; largest > 0.125; largest /= 2) ++squarings;
  for (auto& row : a)
    for (double& entry : row)
      for (int i = 0; i < squarings; ++i) entry /= 2;
  constexpr Matrix kOne{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Matrix sum = kOne;
  for (int n = 16; n > 0; --n) {  // Horner: 1 + a/1 (1 + a/2 (1 + ...)); 0.375^16 / 16! < 1e-20
    sum = product(a, sum);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum[i][j] = kOne[i][j] + sum[i][j] / n;
  }
  for (int i = 0; i < squarings; ++i) sum = product(sum, sum);
  return sum;
}

}  // namespace

void wander(const WanderingOptions& options, const Vec3& low, const Vec3& high,
            std::uint64_t session, std::vector<Vec3>& places) {
  SplitMix64 random(mix(options.seed) + session);
  const auto anywhere = [&] {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = low[a] + random.part() * (high[a] - low[a]);
    return x;
  };
  const auto ticks_of = [&](double seconds) {
    // In this order a NaN, which a box without end has for lengths, is the most, too.
    return static_cast<std::size_t>(std::min(0x1p40, std::ceil(seconds * options.rate_hz)));
  };
  const std::size_t ticks = std::max<std::size_t>(ticks_of(options.seconds), 1);
  Vec3 from = anywhere();
  places.assign(1, from);
  while (places.size() < ticks) {
    if (random.below(2) == 0)
      places.resize(std::min(places.size() + ticks_of(options.hold), ticks), from);
    const Vec3 to = anywhere();
    const Vec3 way{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const double length = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    const double speed = options.speed * (1 + 3 * random.part()) / 4;
    const std::size_t leg = ticks_of(length / speed);
    for (std::size_t i = 1; i <= leg && places.size() < ticks; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(leg);
      const double s = t * t * t * (10 - 15 * t + 6 * t * t);
      places.push_back({from[0] + s * way[0], from[1] + s * way[1], from[2] + s * way[2]});
    }
    from = to;
  }
}

SimulatedDevice::SimulatedDevice(const SimulatedOptions& options, Targets targets)
    : options_(options),
      source_(std::move(targets)),
      sent_(std::size_t{options.delay} + 1, Vec3{0, 0, 0}) {
  const double dt = 1 / options.rate_hz;
  const double spring = options.stiffness / options.mass;
  const double friction = options.hand_damping / options.mass;
  // u' = w, w' = -spring u - friction w + a, a' = 0.
  const Matrix e = exponential({{{0, dt, 0}, {-spring * dt, -friction * dt, dt}, {0, 0, 0}}});
  step_ = {e[0], e[1]};
}

DeviceInfo SimulatedDevice::info(const SimulatedOptions& options) {
  const double half = options.reach / 2;
  return {.name = "simulated",
          .unit = DeviceInfo::Unit::kMetres,
          .low = {-half, -half, -half},
          .high = {half, half, half}};
}

DeviceStatus SimulatedDevice::read(DeviceInput& input) noexcept {
  const bool over = started_ && at_ + 1 == targets_.size();
  if (over && session_ + 1 == options_.sessions) return DeviceStatus::kEnd;
  const bool begins = over || !started_;
  if (over) ++session_;
  if (begins)
    begin();
  else
    advance();
  input = {.hand = target(), .begins = begins};
  for (int a = 0; a < 3; ++a)
    input.position[a] = options_.encoder > 0
                            ? std::floor(x_[a] / options_.encoder + 0.5) * options_.encoder
                            : x_[a];
  return DeviceStatus::kOk;
}

DeviceStatus SimulatedDevice::send(const Vec3& force) noexcept {
  newest_ = (newest_ + 1) % sent_.size();
  sent_[newest_] = force;
  return DeviceStatus::kOk;
}

void SimulatedDevice::begin() {
  source_(session_, targets_);
  started_ = true;
  at_ = 0;
  x_ = targets_.front();
  v_ = {0, 0, 0};
  work_ = 0;
  std::fill(sent_.begin(), sent_.end(), Vec3{0, 0, 0});
}

void SimulatedDevice::advance(double& x, double& v, double force, double from,
                              double to) const noexcept {
  const double speed = (to - from) / (1 / options_.rate_hz);
  const double u = x - from;
  const double w = v - speed;
  const double a = force / options_.mass;
  x = to + (step_[0][0] * u + step_[0][1] * w + step_[0][2] * a);
  v = speed + (step_[1][0] * u + step_[1][1] * w + step_[1][2] * a);
}

void SimulatedDevice::advance() {
  const Vec3& force = sent_[(newest_ + 1) % sent_.size()];  // the oldest
  for (int a = 0; a < 3; ++a) {
    const double before = x_[a];
    advance(x_[a], v_[a], force[a], targets_[at_][a], targets_[at_ + 1][a]);
    work_ += force[a] * (x_[a] - before);
  }
  ++at_;
}

}  // namespace hapgrid
