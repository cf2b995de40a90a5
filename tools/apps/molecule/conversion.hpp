// The conversion function C(s, x, d) of a molecule. The HIP moves in small steps; at each step the
// state goes down to the minimum of the hybrid energy in whose basin it is. Where it leaves its
// branch the steps are smaller still.
#pragma once

#include "tools/apps/molecule/energy.hpp"
#include "tools/apps/molecule/minima.hpp"
#include "tools/apps/molecule/minimiser.hpp"

namespace hapgrid::molecule {

/// States are rounded to multiples of this (Å, rad, 1), which is far below any sensible tolerance.
/// Rounded states compress well, and they are equal where the same minimum was reached twice.
inline constexpr double kStateUnit = 0x1p-20;
/// A variable of a state, rounded so.
double rounded_state(double v);

class Conversion {
 public:
  /// @param molecule that of the energy
  /// @param substep the HIP's longest move between two minimisations, Å
  Conversion(const Molecule& molecule, HybridEnergy& energy, double substep,
             const MinimiserLimits& limits);

  const Minima& minima() const { return minima_; }

  /// C(s, x, d) into `result` (n numbers; may be s).
  /// @throw std::runtime_error when a minimisation does not converge.
  void convert(const double* s, const double* x, const double* d, double* result);

 private:
  /// The HIP comes to x by one move, along which the state follows it down.
  void follow(double* state, const double* x, const double* move, bool last);

  HybridEnergy& energy_;
  double substep_;
  Minima minima_;
  Minimiser minimiser_;
};

}  // namespace hapgrid::molecule
