// The hung ball once more, from the paper and from the definition in words, in long double and
// with angles: slow, independent of the plug-in, and the oracle of its tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "libcore/grid/vec3.hpp"
#include "libcore/model/plugin_model.hpp"

namespace hung_ball {

using hapgrid::length_of, hapgrid::operator+, hapgrid::operator-, hapgrid::operator*;
using hapgrid::Vec3;
using Real = long double;

inline constexpr double kRadius = 0.1;
inline constexpr Real kPi = std::numbers::pi_v<Real>;
/// The unit roundoff of the plug-in's arithmetic.
inline constexpr double kU = 0x1p-53;

inline std::unique_ptr<hapgrid::Model> make(
    const std::vector<hapgrid::Parameter>& parameters = {}) {
  return hapgrid::Plugin("hung-ball", {HAPGRID_BUILD_DIR "/models"}).create(parameters);
}

/// C(α, x, d) of the plug-in; not a number when it fails.
inline double convert(hapgrid::Model& model, double alpha, const Vec3& x, const Vec3& d) {
  double reached = 0;
  return model.convert(&alpha, x, d, &reached) ? reached : std::nan("");
}

/// The arc of overlap about φ, half as wide as 2δ.
struct Arc {
  Real phi, delta;
};

inline std::optional<Arc> arc(const Vec3& p, Real r) {
  const Real w = 1 - Real{p[2]};
  const Real rho = std::hypot(Real{p[0]}, w);
  const Real m = 4 * r * r - Real{p[1]} * p[1];
  const Real quotient = (1 + rho * rho - m) / (2 * rho);
  if (m <= 0 || quotient >= 1) return std::nullopt;
  return Arc{std::atan2(Real{p[0]}, w), std::acos(quotient)};
}

/// C as it is defined, substep by substep.
inline Real reference(Real alpha, const Vec3& x, const Vec3& d, Real r) {
  const Real length = std::sqrt(Real{d[0]} * d[0] + Real{d[1]} * d[1] + Real{d[2]} * d[2]);
  const Real substeps = std::ceil(length / (r / 16));
  for (Real k = 1; k <= substeps; ++k) {
    // The end is where the plug-in has it, so that both see the same HIP to the last bit.
    const double f = static_cast<double>(k / substeps);
    const Vec3 p = x + f * d;
    const std::optional<Arc> a = arc(p, r);
    if (!a) {
      alpha = 0;
    } else if (alpha >= a->phi) {
      alpha = std::max(Real{0}, a->phi + a->delta);
      if (alpha >= kPi) alpha = 0;
    } else {
      alpha = std::min(Real{0}, a->phi - a->delta);
      if (alpha <= -kPi) alpha = 0;
    }
  }
  return alpha;
}

/// How far the plug-in's contact angle at p may be from the exact one; any r < 1/2, so that m < 1,
/// |e - m| < 2 on an arc, and ρ < 2. Rounding leaves 9u in e = x² + z (z - 2), 3u in m and 2u in
/// their difference, hence 4 * 14u + 4u in its square, 12u in 4m and 4u in s² = 4m - (e - m)²: less
/// than 80u, which is 40u/s in s = 2ρ sin δ. With at most 20u in 2ρ cos δ, δ is off by
/// (40u/s + 20u) / 2ρ, φ by 3u/ρ through 1 - z, and the last sums and atan2 by 10u.
inline double angle_bound(const Arc& a, const Vec3& p) {
  const double rho = std::hypot(p[0], 1 - p[2]);
  const double s = 2 * rho * static_cast<double>(std::sin(a.delta));
  return kU * (10 + (40 / s + 26) / (2 * rho));
}

/// α1(x): the root of the paper's (1 - cos α)² + (x - sin α)² = 4r² that is right of the HIP, for
/// -2r <= x < t, by bisection between the overlap at φ and the free angle φ + π/2.
inline Real alpha_1(Real x, Real r) {
  const auto f = [&](Real alpha) {
    const Real h = 1 - std::cos(alpha);
    const Real v = x - std::sin(alpha);
    return h * h + v * v - 4 * r * r;
  };
  Real inside = std::atan(x);
  Real outside = inside + kPi / 2;
  for (;;) {
    const Real middle = (inside + outside) / 2;
    if (middle == inside || middle == outside) return middle;
    (f(middle) < 0 ? inside : outside) = middle;
  }
}
inline Real alpha_2(Real x, Real r) { return -alpha_1(-x, r); }

/// A generator whose numbers do not depend on the standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  /// A point of the box of hung-ball.toml.
  Vec3 point() { return {between(-0.975, 0.975), between(-0.475, 0.475), between(-0.475, 0.475)}; }
  /// A shift, uniform in the ball of the radius `longest`.
  Vec3 shift(double longest) {
    for (;;) {
      const Vec3 d{between(-1, 1), between(-1, 1), between(-1, 1)};
      if (length_of(d) <= 1) return longest * d;
    }
  }

 private:
  std::mt19937_64 bits_;
};

/// Calls f(α, x, d) for each of the steps of a random walk of the HIP about the circle on which the
/// ball swings; the model is in a feasible state all the time. Steps have lengths up to `longest`.
template <class F>
void walk(hapgrid::Model& model, double r, std::uint64_t seed, int steps, double longest, F&& f) {
  Random random(seed);
  Vec3 x{-3 * r, 0, 0};
  double alpha = 0;
  double along = 0;  // where on the circle
  for (int i = 0; i < steps; ++i) {
    along = std::clamp(along + random.between(-0.5, 0.5) * longest, -2.5, 2.5);
    const double rho = 1 + random.between(-2.2, 2.2) * r;
    const Vec3 to{rho * std::sin(along), random.between(-2.2, 2.2) * r, 1 - rho * std::cos(along)};
    const double most = std::min(1.0, longest / length_of(to - x));
    const Vec3 d = random.between(0, 1) * most * (to - x);
    f(alpha, x, d);
    alpha = convert(model, alpha, x, d);
    x = x + d;
    if (alpha == 0) along *= 0.8;  // back to where the ball hangs
  }
}

}  // namespace hung_ball
