// Force, energy and shape of a model in some states, and whether the force is the energy's negative
// gradient: as check-model and verify ask it.
#pragma once

#include <span>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/model/fields.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

class ForceCheck {
 public:
  /// @param spec, model outlive this.
  ForceCheck(const GridSpec& spec, Model& model);

  bool has_force() const { return fields_.has_force(); }
  /// Evaluates them with the HIP at x, in a state that was reached there. Counts in `finite` what
  /// must be finite. Also compares the force with the slopes of the energy along the axes, or along
  /// one axis after the other when there are many: of the states that the model takes on when the
  /// HIP moves a little to either side, where both come back to the state (no tear-off in between).
  void try_at(const Vec3& x, std::span<const double> state, Findings& finite);
  /// `gradient`: forces that are not the slope of the energy, and axes along which they are another
  /// multiple of it. Says also what the forces have in common that are no gradients: a factor, a
  /// sign.
  Check gradient() const;
  /// The rows `gradient`, where there is something to compare, and, where forces are beyond what
  /// devices send, `strong`.
  std::vector<Check> checks() const;

  std::vector<double> force_seconds, shape_seconds;  ///< of each call
  double largest_force = 0;                          ///< newtons
  /// Median error of the force's nonzero components against the energy's gradient, as a share of
  /// the largest force.
  double median_error() const;

 private:
  struct Gradient {
    double force;
    double slope;    ///< of the energy
    double nearest;  ///< to the force, of the slopes to both sides
    Vec3 x;
    int axis;
  };

  void add_gradient(const Vec3& x, const std::vector<double>& row, const Vec3& force, int axis);
  std::string diagnosis() const;
  std::string axis_diagnosis(int axis) const;

  const GridSpec& spec_;
  Model& model_;
  const Fields fields_;
  const bool is_stored_;  // whether there is more in a row than the state
  std::vector<Gradient> gradients_;
  int places_ = 0;  // where gradients were asked for
  Findings strong_;
};

}  // namespace hapgrid
