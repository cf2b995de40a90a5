// Force, energy and shape of a model in states along walks (model_check.hpp), and whether the force
// is the energy's negative gradient.
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
  /// must be finite. Also compares a force with the slope of the energy along one axis: of the
  /// states that the model takes on when the HIP moves a little to either side, where both come
  /// back to the state (no tear-off in between).
  void try_at(const Vec3& x, std::span<const double> state, Findings& finite);
  /// The rows `gradient` and, where forces are beyond what devices send, `strong`. Says also what
  /// the forces have in common that are no gradients: a factor, a sign.
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

  void add_gradient(const Vec3& x, const std::vector<double>& row, const Vec3& force);
  std::string diagnosis() const;

  const GridSpec& spec_;
  Model& model_;
  const Fields fields_;
  const bool is_stored_;  // whether there is more in a row than the state
  std::vector<Gradient> gradients_;
  Findings strong_;
};

}  // namespace hapgrid
