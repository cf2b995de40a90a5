// Sine, cosine and arctangent with the same bits on every machine. The C library chooses among
// variants by processor (with and without fused multiply-add), and their results differ in the last
// bit; but a grid must not depend on where its shards were computed. Here only +, -, *, / and sqrt
// are used, whose results IEEE 754 fixes, and the project is compiled without contraction.
#pragma once

#include <cmath>
#include <cstddef>

namespace hapgrid::molecule {

inline constexpr double kPi = 3.14159265358979323846;

/// Sines and cosines of `count` angles, in radians. There are no branches, so that compilers
/// vectorise it. The error is below 1e-15 for angles up to 1e5; beyond 1e8 the results mean
/// nothing. Real-time safe.
///
/// The nearest multiple of π is subtracted from the angle, which changes only the sign of the
/// result. Taylor polynomials serve for the rest: their first omitted terms at π/2 are below 2e-17.
inline void sines_and_cosines(const double* angles, double* sines, double* cosines,
                              std::size_t count) {
  // Adding and subtracting 1.5 * 2^52 rounds to a whole number.
  constexpr double kRound = 6755399441055744.0;
  // π in three parts (Cody and Waite); the first two have 33 bits, so that products with n are
  // exact.
  constexpr double kPi1 = 0x1.921fb544p+1, kPi2 = 0x1.0b4611a6p-33, kPi3 = 0x1.3198a2e037073p-68;
  for (std::size_t i = 0; i < count; ++i) {
    const double n = (angles[i] * (1 / kPi) + kRound) - kRound;
    const double half = (n * 0.5 + kRound) - kRound;
    const double odd = n - 2 * half;
    const double sign = 1 - 2 * odd * odd;
    const double r = ((angles[i] - n * kPi1) - n * kPi2) - n * kPi3;
    const double z = r * r;
    double s = 1.0 / 51090942171709440000.0;  // 1/21!
    s = s * z - 1.0 / 121645100408832000.0;
    s = s * z + 1.0 / 355687428096000.0;
    s = s * z - 1.0 / 1307674368000.0;
    s = s * z + 1.0 / 6227020800.0;
    s = s * z - 1.0 / 39916800.0;
    s = s * z + 1.0 / 362880.0;
    s = s * z - 1.0 / 5040.0;
    s = s * z + 1.0 / 120.0;
    s = s * z - 1.0 / 6.0;
    double c = 1.0 / 2432902008176640000.0;  // 1/20!
    c = c * z - 1.0 / 6402373705728000.0;
    c = c * z + 1.0 / 20922789888000.0;
    c = c * z - 1.0 / 87178291200.0;
    c = c * z + 1.0 / 479001600.0;
    c = c * z - 1.0 / 3628800.0;
    c = c * z + 1.0 / 40320.0;
    c = c * z - 1.0 / 720.0;
    c = c * z + 1.0 / 24.0;
    c = c * z - 0.5;
    sines[i] = sign * (r + r * z * s);
    cosines[i] = sign * (1 + z * c);
  }
}

/// The angle of (x, y) in [-π, π], 0 for (0, 0). Error below 1e-15.
inline double angle_of(double y, double x) {
  const double ax = std::abs(x), ay = std::abs(y);
  if (ax == 0 && ay == 0) return 0;
  double r = ay < ax ? ay / ax : ax / ay;
  const bool shifted = r > 0.4;  // tan(α - π/4) = (tan α - 1) / (tan α + 1)
  if (shifted) r = (r - 1) / (r + 1);
  const double z = r * r;
  double s = 0;  // the series of the arctangent; |r| <= 0.43, 0.43^47 / 47 < 1e-18
  for (int k = 45; k >= 1; k -= 2) s = 1.0 / k - z * s;
  double angle = r * s + (shifted ? kPi / 4 : 0);
  if (!(ay < ax)) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

/// The angle that differs from `angle` by a multiple of 2π and lies nearest to `reference`.
inline double unwrapped(double angle, double reference) {
  return angle - 2 * kPi * std::floor((angle - reference) / (2 * kPi) + 0.5);
}

/// The number of [0, 1] that is nearest to t, and 0 when t is not a number.
inline double clamped(double t, double low = 0) {
  return t > low ? (t < low + 1 ? t : low + 1) : t <= low ? low : 0;
}

/// The number of [low, low + 1] that differs from t by a whole number, and 0 when t is not a
/// number.
inline double wrapped(double t, double low) {
  return std::abs(t) < 1e9 ? t - std::floor(t - low) : 0;
}

}  // namespace hapgrid::molecule
