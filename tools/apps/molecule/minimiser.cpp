#include "tools/apps/molecule/minimiser.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "tools/apps/molecule/lanes.hpp"

namespace hapgrid::molecule {

namespace {
// The second derivatives of the morph are computed anew every third time: they change slowly.
constexpr int kCurvatureLasts = 3;
// The state rests in a transition state when no step of this length, Å, leads down from there.
constexpr double kLeastNudge = 1e-3;
}  // namespace

/// The p that makes g·p + ½ p·B p (nearly) least for |p| <= radius, after Moré and Sorensen 1983.
/// Deviation: when the least shift that makes B positive definite already gives a step inside the
/// radius, that step is taken.
Minimiser::Vector Minimiser::within(double radius, const Matrix& b, const Vector& g) const {
  double shift = 0;
  double too_low = 0;  // a shift with which B was not positive definite
  const double size = std::max(b.diagonal().cwiseAbs().maxCoeff(), 1e-6);
  Eigen::LLT<Matrix> factors(b.rows());
  for (int round = 0; round < 40; ++round) {
    Matrix shifted = b;
    shifted.diagonal().array() += shift;
    if (factors.compute(shifted).info() != Eigen::Success) {
      too_low = shift;
      shift = std::max(4 * shift, 1e-3 * size);
      continue;
    }
    Vector p = factors.solve(-g);
    const double length = p.norm();
    if (length <= 1.1 * radius) return p;
    const Vector q = factors.matrixL().solve(p);
    const double better = shift + length * length / q.squaredNorm() * (length - radius) / radius;
    shift = std::max(better, 0.5 * (shift + too_low));
  }
  return -g * (radius / std::max(g.norm(), 1e-300));
}

/// The step within the radius and the bounds; returns how far the quadratic model promises H to
/// fall, which may be no fall at all.
HAPGRID_WITH_AVX2
double Minimiser::step(double radius, Vector& p) const {
  const Eigen::Index n = y_.size();
  const auto paths = static_cast<Eigen::Index>(energy_.morph().paths());
  std::array<bool, kMaxVariables> fixed{};
  p.setZero(n);
  for (Eigen::Index k = 0; k < paths; ++k)
    fixed[k] = (y_[k] <= low(k) && gradient_[k] >= 0) || (y_[k] >= high(k) && gradient_[k] <= 0);
  for (Eigen::Index round = 0; round <= paths; ++round) {
    std::array<Eigen::Index, kMaxVariables> free;
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!fixed[i]) free[count++] = i;
    Matrix b(count, count);
    Vector g(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      g[i] = gradient_[free[i]];
      for (Eigen::Index j = 0; j < n; ++j)
        if (fixed[j]) g[i] += hessian_(free[i], j) * p[j];
      for (Eigen::Index j = 0; j < count; ++j) b(i, j) = hessian_(free[i], free[j]);
    }
    const Vector part = within(radius, b, g);
    bool over = false;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index k = free[i];
      p[k] = part[i];
      if (k >= paths) continue;
      const double to = y_[k] + p[k];
      if (to >= low(k) && to <= high(k)) continue;
      p[k] = (to < low(k) ? low(k) : high(k)) - y_[k];
      fixed[k] = true;
      over = true;
    }
    if (!over) break;
  }
  double promised = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    double slope = 0;
    for (Eigen::Index j = 0; j < i; ++j) slope += hessian_(j, i) * p[j];
    promised -= p[i] * (gradient_[i] + slope + 0.5 * hessian_(i, i) * p[i]);
  }
  return promised;
}

HAPGRID_WITH_AVX2
void Minimiser::differentiate(const double* s) {
  const auto n = static_cast<Eigen::Index>(energy_.variables());
  y_.resize(n);
  gradient_.resize(n);
  hessian_.resize(n, n);
  energy_.derivatives(gradient_.data(), hessian_.data(), age_ == 0);
  age_ = (age_ + 1) % kCurvatureLasts;
  for (Eigen::Index i = 0; i < n; ++i) {
    y_[i] = s[i] * energy_.scale(i);
    gradient_[i] /= energy_.scale(i);
    for (Eigen::Index j = 0; j < n; ++j) hessian_(i, j) /= energy_.scale(i) * energy_.scale(j);
  }
}

void Minimiser::add(const Vector& p, double* trial) const {
  const auto paths = static_cast<Eigen::Index>(energy_.morph().paths());
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const double y = y_[i] + p[i];
    trial[i] = i < paths && y <= low(i)    ? energy_.low(i)
               : i < paths && y >= high(i) ? energy_.low(i) + 1
                                           : y / energy_.scale(i);
  }
}

void Minimiser::minimise(double* s, const double* x, bool last) {
  age_ = 0;
  descend(s, x, energy_.value(s, x), last ? limits_.tolerance : limits_.on_the_way);
}

void Minimiser::start(const double* s, const double* x) {
  energy_.value(s, x);
  age_ = 0;
  differentiate(s);
}

// The contacts depend on the difference of the shift and the probe's position. So moving the probe
// by d changes the gradient as moving the shift by -d would, except for the anchor's part; the
// Hessian gives that change.
void Minimiser::follow(double* s, const double* x, const double* d, bool last) {
  const double tolerance = last ? limits_.tolerance : limits_.on_the_way;
  const auto n = static_cast<Eigen::Index>(energy_.variables());
  const auto shift = static_cast<Eigen::Index>(energy_.morph().paths());
  for (Eigen::Index a = 0; a < 3; ++a) {
    gradient_ -= hessian_.col(shift + a) * d[a];
    gradient_[shift + a] += energy_.parameters().shift_stiffness * d[a];
  }
  Vector p(n);
  std::array<double, kMaxVariables> trial;
  const bool moves = step(limits_.max_step, p) > 0;
  if (moves) add(p, trial.data());
  const double stays = energy_.value(s, x);  // cheap: the shape of this s is known
  if (!moves) return descend(s, x, stays, tolerance);
  const double lower = energy_.value(trial.data(), x);
  if (!(lower < stays)) return descend(s, x, energy_.value(s, x), tolerance);
  std::copy_n(trial.begin(), n, s);
  return descend(s, x, lower, tolerance);
}

/// `value` is H(s, x), which was evaluated last.
void Minimiser::descend(double* s, const double* x, double value, double tolerance) {
  const auto n = static_cast<Eigen::Index>(energy_.variables());
  const auto paths = static_cast<Eigen::Index>(energy_.morph().paths());
  Vector p(n);
  std::array<double, kMaxVariables> trial;
  double radius = limits_.max_step;
  for (int evaluations = 1; evaluations < limits_.max_evaluations;) {
    differentiate(s);
    double largest = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool held = i < paths && ((y_[i] <= low(i) && gradient_[i] >= 0) ||
                                      (y_[i] >= high(i) && gradient_[i] <= 0));
      if (!held) largest = std::max(largest, std::abs(gradient_[i]));
    }
    const bool stationary = !(largest > tolerance);
    if (stationary) {
      // A transition state at an end of a path is stationary but no minimum: the energy falls
      // towards the path's inside.
      bool rests = true;
      for (Eigen::Index k = 0; k < paths; ++k) {
        const double inside = y_[k] >= high(k) ? 1 : y_[k] <= low(k) ? -1 : 0;
        if (inside == 0 || inside * gradient_[k] < -limits_.tolerance || !(hessian_(k, k) < 0))
          continue;
        gradient_[k] = inside * limits_.tolerance;
        rests = false;
      }
      if (rests) return;
    }
    for (;;) {
      const double promised = step(radius, p);
      if (promised > 0) {
        add(p, trial.data());
        const double lower = energy_.value(trial.data(), x);
        ++evaluations;
        const double ratio = (value - lower) / promised;
        if (ratio < 0.25) radius = 0.25 * std::min(p.norm(), radius);
        if (ratio > 0.75) radius = std::min(2 * radius, limits_.max_step);
        if (lower < value) {
          value = lower;
          std::copy_n(trial.begin(), n, s);
          break;
        }
      } else {
        radius *= 0.25;
      }
      if (stationary && radius < kLeastNudge) return;
      if (evaluations >= limits_.max_evaluations || radius < 1e-12) {
        evaluations = limits_.max_evaluations;
        break;
      }
    }
  }
  char line[160];
  std::snprintf(line, sizeof line,
                "the minimisation at (%.6g, %.6g, %.6g) does not converge in %d evaluations", x[0],
                x[1], x[2], limits_.max_evaluations);
  throw std::runtime_error(line);
}

}  // namespace hapgrid::molecule
