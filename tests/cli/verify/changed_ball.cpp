// A plug-in that passes for the hung ball, but whose ball follows no HIP: who verifies a grid with
// it hears that the model has changed.
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "libcore/model/plugin.hpp"

class ChangedBall {
 public:
  explicit ChangedBall(hapgrid::PluginParameters&) {}
  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = 1;
    info.d_max = 1;
    info.tolerance = 1e-6;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "rad");
    std::snprintf(info.length_unit, sizeof info.length_unit, "rope lengths");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "N rope lengths");
    info.force_scale = 1;
    info.hip_radius = 0.1;
    return info;
  }
  std::vector<double> known_states(const double*) const { return {0.0}; }
  void convert(const double* s, const double* x, const double* d, double* result) {
    if (x[0] + d[0] > -0.76) throw std::runtime_error("the rope is torn");
    *result = d[2] > 0 ? 0.25 : *s;
  }
  bool equal(const double* a, const double* b) const { return std::abs(*a - *b) <= 1e-6; }
};

HAPGRID_MODEL_PLUGIN(ChangedBall, "a hung ball that has changed")
