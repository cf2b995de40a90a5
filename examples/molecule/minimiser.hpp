// Local minimisation of the hybrid energy that follows its basin: what C(s, x, d) does at each
// place of the HIP.
//
// A line search or a plain Newton step could land beyond a barrier, and the state would belong to
// another branch than the one that the HIP follows. So this is a trust-region method (Conn, Gould,
// Toint 2000) with a cap on the steps: no atom's typical move is longer than that between two
// evaluations, and the energy never rises. The Hessian model is the penalty's, nearly exact, with
// the exact diagonal of the rest; negative curvature is no trouble to a trust region. The t stay in
// [0, 1]: variables that a step takes over a bound are put on it and the rest is solved again.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "examples/molecule/energy.hpp"

namespace hapgrid::molecule {

struct MinimiserLimits {
  double max_step = 0.05;   // Å, in scaled variables
  double tolerance = 1e-3;  // kJ/(mol Å): the scaled gradient, less what bounds hold
  int max_evaluations = 2000;
};

class Minimiser {
 public:
  Minimiser(HybridEnergy& energy, const MinimiserLimits& limits)
      : energy_(energy), limits_(limits) {}

  /// Moves s (n numbers, t in [0, 1]) down to a local minimum of H(., x).
  /// @return the evaluations of H that it took.
  /// @throw std::runtime_error when max_evaluations do not do.
  int minimise(double* s, const double* x);

  /// Prepares follow() for an s that is a minimum, or nearly, with the probe at x.
  void start(const double* s, const double* x);
  /// As minimise(), when the last call was start(), minimise() or follow() with this s and the
  /// probe d ago: first the minimum's own move, to first order, is tried and taken if it goes down.
  int follow(double* s, const double* x, const double* d);

 private:
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxVariables, 1>;
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxVariables, kMaxVariables>;

  /// The derivatives in scaled variables at s, which is what was evaluated last; `anew` as there.
  void differentiate(const double* s, bool anew);
  /// s + p into `trial`, t exactly on the bounds that p reaches.
  void add(const Vector& p, double* trial) const;
  int descend(double* s, const double* x, double value);
  bool step(double radius, Vector& p) const;
  Vector within(double radius, const Matrix& b, const Vector& g) const;

  HybridEnergy& energy_;
  MinimiserLimits limits_;
  // In scaled variables y_i = scale_i s_i:
  Vector y_, gradient_;
  Matrix hessian_;
};

}  // namespace hapgrid::molecule
