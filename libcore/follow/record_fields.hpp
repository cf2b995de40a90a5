// Force and energy at a grid's records, as play interpolates them, and whether the force is the
// negated gradient of the energy.
//
// Each record's force along an axis is predicted from its two neighbours on the same branch, once
// by a Hermite polynomial from their energies and forces, once as the mean of their forces. If the
// force is the gradient of the energy, the first prediction is far better. The residual of energies
// against forces is no measure: it is larger on a good coarse grid than on a spoilt fine one.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

/// By record.
struct RecordFields {
  std::vector<Vec3> force;     ///< newtons
  std::vector<double> energy;  ///< newtons times the unit of length; empty where it is not known
};

/// The grid's stored values, or else the model's.
/// @param create makes the grid's model; called only where the grid does not store the force, in
/// the calling thread, once for each of `threads`. The result does not depend on `threads`.
/// @throw ModelError when no force can be had; what `create` throws.
RecordFields record_fields(const Grid& grid, const MakeModel& create, int threads);

/// What a wave of the force leaves of both predictions shows when a grid is fine enough. With t the
/// phase of the wave along one spacing, sinc t = sin t / t, they are off by
///   by energy  1 - 3/2 sinc t + 1/2 cos t,   by forces  1 - cos t
/// of the force. Up to two points a wave (t = pi) the first is at most 1/4 of the second; of a kink
/// it is 0.16, and of a jump 1/2 (root mean squares over all places between two points). Of forces
/// that are composed of these it is no more than the largest. So beyond 1/2 the grid does not
/// resolve the force, or the force is not the gradient of the energy: the grid cannot tell which,
/// and the model can (check/gradient.hpp).
struct Agreement {
  std::uint64_t predictions = 0;
  double force = 0;      ///< newtons, root mean square of the components that were predicted
  double by_energy = 0;  ///< newtons, root mean square of the error by energies and forces
  double by_forces = 0;  ///< newtons, the same of the mean of the forces

  /// Adds a prediction: the force of a record, and energy and force on both sides, `h` away.
  void add(double force_here, double force_low, double force_high, double energy_low,
           double energy_high, double h);
  /// Makes root mean squares of what was added.
  void finish();

  /// Whether play takes the energy: where it says more of the forces than the forces beside them.
  /// Where forces are linear both errors are rounding, so a small one is good as well: an energy
  /// that is off by a fifth has 0.3 of the force.
  bool is_good() const { return predictions > 0 && (by_energy < by_forces || is_small()); }
  /// Whether the grid shows by itself that the force is the gradient of the energy.
  bool is_sure() const { return predictions > 0 && (by_energy <= by_forces / 2 || is_small()); }

 private:
  bool is_small() const { return by_energy <= 0.05 * force; }
};

/// @param fields with energies
Agreement agreement(const Grid& grid, const RecordFields& fields);

}  // namespace hapgrid
