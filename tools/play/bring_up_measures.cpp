#include "tools/play/bring_up_measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "libcore/loop/energy_tank.hpp"

namespace hapgrid {

namespace {

// Between two changes of sign: ticks. Hands swing at some 5 to 10 Hz.
constexpr std::array kHolds{20, 45, 30, 80, 25, 60, 35, 70, 50, 97};

constexpr int kWindow = 24;          // ticks to each side
constexpr double kExplained = 0.25;  // part of the motion that a fit has to explain
// Rounding in floating point is no step of an encoder.
constexpr double kNoStep = 1e-9;
// A fast hand skips steps.
constexpr double kSmallPart = 0.05;

/// The window (1 - (t / kWindow)^2)^4 and its first two derivatives.
std::array<double, 3> window(double t) noexcept {
  const double u = t / kWindow, v = 1 - u * u;
  if (v <= 0) return {0, 0, 0};
  return {std::pow(v, 4), -8 * u * std::pow(v, 3) / kWindow,
          (48 * u * u * v * v - 8 * std::pow(v, 3)) / (kWindow * kWindow)};
}

using Column = std::array<double, kShakeTicks>;

double product(const Column& a, const Column& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Takes away from `from` what lies along `along`.
void take_away(Column& from, const Column& along) {
  const double square = product(along, along);
  const double part = square > 0 ? product(from, along) / square : 0;
  for (std::size_t i = 0; i < from.size(); ++i) from[i] -= part * along[i];
}

/// The part of x'' that no mass, spring and damper explains whose force acts after so many ticks.
double unexplained(const Shaken& axis, std::size_t delay) {
  enum { kConstant, kOfForce, kOfSpeed, kOfPlace, kTerms };
  std::array<Column, kTerms> terms{};
  Column wanted{};
  for (std::size_t centre = 0; centre < kShakeTicks; ++centre) {
    terms[kConstant][centre] = 1;
    for (int t = -kWindow; t <= kWindow; ++t) {
      const std::size_t tick = centre + kShakeTicks + static_cast<std::size_t>(t);
      const auto [w, first, second] = window(t);
      const double x = axis.position(tick % kShakeTicks);
      wanted[centre] += second * x;
      terms[kOfSpeed][centre] += first * x;
      terms[kOfPlace][centre] += w * x;
      // A force holds for a tick, so that it counts at the tick's middle.
      terms[kOfForce][centre] += window(t + 0.5)[0] * axis.force((tick - delay) % kShakeTicks);
    }
  }
  // Gram and Schmidt: each term without those before it.
  for (int i = 0; i < kTerms; ++i) {
    for (int k = 0; k < i; ++k) take_away(terms[i], terms[k]);
    if (i == kConstant) take_away(wanted, terms[i]);
  }
  const double all = product(wanted, wanted);
  for (int i = kOfForce; i < kTerms; ++i) take_away(wanted, terms[i]);
  return all > 0 ? product(wanted, wanted) / all : 1;
}

}  // namespace

double encoder_step(std::span<const Vec3> positions) {
  double step = 0;
  for (int a = 0; a < 3; ++a) {
    std::vector<double> changes;
    for (std::size_t i = 1; i < positions.size(); ++i)
      if (const double change = std::abs(positions[i][a] - positions[i - 1][a]); change > kNoStep)
        changes.push_back(change);
    if (changes.empty()) continue;
    const auto nth = changes.begin() +
                     static_cast<std::ptrdiff_t>(kSmallPart * static_cast<double>(changes.size()));
    std::nth_element(changes.begin(), nth, changes.end());
    step = std::max(step, *nth);
  }
  return step;
}

double noise_of(std::span<const Vec3> positions) {
  double noise = 0;
  for (int a = 0; a < 3 && !positions.empty(); ++a) {
    const auto [low, high] =
        std::minmax_element(positions.begin(), positions.end(),
                            [a](const Vec3& x, const Vec3& y) { return x[a] < y[a]; });
    noise = std::max(noise, (*high)[a] - (*low)[a]);
  }
  return noise;
}

double shake(std::uint64_t tick) noexcept {
  auto left = static_cast<int>(tick % kShakeTicks);
  double sign = 1;
  for (const int hold : kHolds) {
    left -= hold;
    if (left < 0) break;
    sign = -sign;
  }
  return sign;
}

void Shaken::add(std::uint64_t tick, double force, double position) {
  Sum& sum = sums_[tick % kShakeTicks];
  sum.force += force;
  sum.position += position;
  sum.count += 1;
}

double Shaken::force(std::size_t tick) const noexcept {
  return sums_[tick].force / std::max(sums_[tick].count, 1.0);
}

double Shaken::position(std::size_t tick) const noexcept {
  return sums_[tick].position / std::max(sums_[tick].count, 1.0);
}

std::optional<std::uint32_t> delay_of(std::span<const Shaken> axes) {
  std::optional<std::uint32_t> best;
  double least = 1 - kExplained;
  for (std::uint32_t delay = 0; delay <= kMaxTankDelay; ++delay) {
    double rest = 0;
    for (const Shaken& axis : axes)
      rest += unexplained(axis, delay) / static_cast<double>(axes.size());
    if (rest >= least) continue;
    least = rest;
    best = delay;
  }
  return best;
}

}  // namespace hapgrid
