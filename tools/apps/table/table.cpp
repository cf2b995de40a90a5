// A table of energies that a point moves through: the plug-in. It has one level, and its state is
// one number that is always 0.
#include <cstdint>
#include <cstdio>
#include <hapgrid/plugin.hpp>
#include <string>
#include <vector>

#include "tools/apps/table/field.hpp"

namespace {

using namespace hapgrid::table;

// A shift of any length is one question to the spline.
constexpr double kMaxShift = 1e9;

FieldOptions read_options(hapgrid::PluginParameters& parameters) {
  FieldOptions options;
  options.factor = parameters.number("factor", 1);
  options.wall = parameters.number("wall", 0);
  options.has_wall = parameters.has("wall");
  return options;
}

class TableModel {
 public:
  explicit TableModel(hapgrid::PluginParameters& parameters)
      : lattice_(read_lattice(parameters.text("table", ""), "table")),
        field_(lattice_, read_options(parameters), "table"),
        length_unit_(parameters.text("length_unit", "")),
        energy_unit_(parameters.text("energy_unit", "")),
        force_scale_(parameters.positive("largest_force", 3) / field_.steepest()) {
    marker_ = parameters.positive("marker", 0.25);
    lattice_.values = {};
    parameters.finish();
  }

  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = 1;
    info.d_max = kMaxShift;
    std::snprintf(info.length_unit, sizeof info.length_unit, "%s", length_unit_.c_str());
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "%s", energy_unit_.c_str());
    info.force_scale = force_scale_;
    info.hip_radius = marker_;
    info.spheres = static_cast<std::uint32_t>(lattice_.atoms.size() + field_.minima().size());
    return info;
  }

  std::vector<double> known_states(const double*) const { return {0}; }

  void convert(const double*, const double*, const double*, double* result) { *result = 0; }

  bool equal(const double*, const double*) const { return true; }

  void force(const double* x, const double*, double* f) {
    field_.at(x, f);
    for (int a = 0; a < 3; ++a) f[a] *= -force_scale_;
  }

  double energy(const double* x, const double*) {
    double gradient[3];
    return field_.at(x, gradient);
  }

  void spheres(hapgrid_sphere* spheres) const {
    for (const Atom& atom : lattice_.atoms) {
      hapgrid_sphere& sphere = *spheres++;
      look_of(atom.label, sphere.radius, sphere.colour);
      sphere.radius *= 0.3F;  // the field is felt between the atoms, so they must not hide it
      std::snprintf(sphere.label, sizeof sphere.label, "%s", atom.label.c_str());
    }
    // The ball at the HIP must not vanish in one that marks a minimum.
    for (std::size_t m = 0; m < field_.minima().size(); ++m)
      *spheres++ = {static_cast<float>(marker_ / 2), {0.2F, 0.5F, 0.9F}, ""};
  }

  void shape(const double*, float* centres) const {
    const auto write = [&](const Vector& x) {
      for (const double c : x) *centres++ = static_cast<float>(c);
    };
    for (const Atom& atom : lattice_.atoms) write(atom.position);
    for (const Vector& minimum : field_.minima()) write(minimum);
  }

 private:
  Lattice lattice_;
  Field field_;
  std::string length_unit_, energy_unit_;
  double force_scale_, marker_ = 0;
};

}  // namespace

HAPGRID_MODEL_PLUGIN(TableModel, "a table of energies, interpolated by tricubic splines")
