// Local minimisation of the hybrid energy: what C(s, x, d) does at each place of the HIP. It must
// stay in the basin where it starts.
//
// A line search or a plain Newton step could land beyond a barrier, and the state would belong to
// another branch than the one that the HIP follows. So this is a trust-region method (Conn, Gould,
// Toint 2000) with a limit on the steps' length: between two evaluations no atom typically moves
// farther, and the energy never rises. The Hessian of the penalty is nearly exact, that of the rest
// diagonal and exact; a trust region copes with negative curvature. The t stay in their range: a
// step that takes variables over a bound puts them on it and is then solved again for the others.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>

#include "tools/apps/molecule/energy.hpp"

namespace hapgrid::molecule {

struct MinimiserLimits {
  double max_step = 0.05;   // Å, in scaled variables
  double tolerance = 1e-3;  // kJ/(mol Å): largest scaled gradient of a variable not held by a bound
  double on_the_way =
      0.05;  // the same between substeps: what is left goes into the next one's step
  int max_evaluations = 2000;
};

class Minimiser {
 public:
  Minimiser(HybridEnergy& energy, const MinimiserLimits& limits)
      : energy_(energy), limits_(limits) {}

  /// Moves s (n numbers, t in their range) down to a local minimum of H(., x): nearly, unless it is
  /// for the last time before the state is used.
  /// @throw std::runtime_error when it takes more than max_evaluations
  void minimise(double* s, const double* x, bool last);

  /// Prepares follow() for an s that is (nearly) a minimum with the probe at x.
  void start(const double* s, const double* x);
  /// As minimise(), but the last call must have been start(), minimise() or follow() with this s
  /// and with the probe at x - d. The minimum's own move is tried first, to first order, and taken
  /// when it lowers H.
  void follow(double* s, const double* x, const double* d, bool last);

 private:
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxVariables, 1>;
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxVariables, kMaxVariables>;

  /// The derivatives in scaled variables at s, where H was evaluated last.
  void differentiate(const double* s);
  /// Sets `trial` to s + p, with t exactly on the bounds that p reaches.
  void add(const Vector& p, double* trial) const;
  void descend(double* s, const double* x, double value, double tolerance);
  /// The bounds of variable k, which is a t, in scaled variables. A path that closes has none.
  double low(Eigen::Index k) const {
    return energy_.closes(k) ? -kNoBound : energy_.low(k) * energy_.scale(k);
  }
  double high(Eigen::Index k) const {
    return energy_.closes(k) ? kNoBound : (energy_.low(k) + 1) * energy_.scale(k);
  }
  static constexpr double kNoBound = std::numeric_limits<double>::infinity();
  double step(double radius, Vector& p) const;
  Vector within(double radius, const Matrix& b, const Vector& g) const;

  HybridEnergy& energy_;
  MinimiserLimits limits_;
  int age_ = 0;  // of the second derivatives of the morph; 0: compute them anew
  // In scaled variables y_i = scale_i s_i:
  Vector y_, gradient_;
  Matrix hessian_;
};

}  // namespace hapgrid::molecule
