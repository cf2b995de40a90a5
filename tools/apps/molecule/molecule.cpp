// A flexible molecule that a probe ball pushes and twists (Sect. 3 of the paper): the plug-in.
#include <cstdio>
#include <cstring>
#include <hapgrid/plugin.hpp>
#include <memory>
#include <string>
#include <vector>

#include "tools/apps/molecule/conversion.hpp"
#include "tools/apps/molecule/sanity.hpp"
#include "tools/apps/molecule/setup.hpp"

namespace {

using namespace hapgrid::molecule;

// A shift of any length could be divided into substeps; no grid of a molecule asks for a longer
// one.
constexpr double kMaxShift = 8;  // Å

class MoleculeModel {
 public:
  explicit MoleculeModel(hapgrid::PluginParameters& parameters)
      : setup_(read_setup(parameters)),
        energy_(setup_.molecule, setup_.energy),
        comparing_(std::make_unique<HybridEnergy>(energy_)),
        conversion_(setup_.molecule, energy_, setup_.substep, MinimiserLimits()) {}

  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = static_cast<std::uint32_t>(energy_.variables());
    info.d_max = kMaxShift;
    info.tolerance = setup_.tolerance;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "angstrom RMSD");
    std::snprintf(info.length_unit, sizeof info.length_unit, "angstrom");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "kJ/mol");
    info.force_scale = setup_.force_scale;
    info.hip_radius = setup_.energy.probe_radius;
    info.spheres = static_cast<std::uint32_t>(setup_.molecule.atoms.size());
    info.torsions = static_cast<std::uint32_t>(setup_.torsions.size());
    return info;
  }

  std::vector<double> known_states(const double* x) const {
    const Minima& minima = conversion_.minima();
    std::vector<double> known;
    for (std::size_t m = 0; m < minima.size(); ++m)
      if (!minima.touched(m, x))
        known.insert(known.end(), minima.state(m).begin(), minima.state(m).end());
    return known;
  }

  void convert(const double* s, const double* x, const double* d, double* result) {
    conversion_.convert(s, x, d, result);
  }

  bool equal(const double* a, const double* b) const {
    if (std::equal(a, a + energy_.variables(), b)) return true;
    return comparing_->displacement(a, b) <= setup_.tolerance;
  }

  void force(const double* x, const double* s, double* f) {
    energy_.force(s, x, f);
    for (int a = 0; a < 3; ++a) f[a] *= setup_.force_scale;
  }

  double energy(const double* x, const double* s) { return energy_.value(s, x); }

  void spheres(hapgrid_sphere* spheres) const {
    for (const Element* element : setup_.molecule.atoms) {
      hapgrid_sphere& sphere = *spheres++;
      sphere.radius = static_cast<float>(element->radius);
      std::copy_n(element->colour, 3, sphere.colour);
      std::snprintf(sphere.label, sizeof sphere.label, "%s", element->symbol);
    }
  }

  void shape(const double* s, float* centres) { energy_.positions(s, centres); }

  double own_energy(const double* s) { return energy_.shape_energy(s); }

  std::vector<std::string> check() {
    std::vector<std::string> lines;
    for (const Problem& problem : Sanity(setup_.molecule, energy_).problems())
      lines.push_back(problem.line());
    return lines;
  }

  void torsions(hapgrid_torsion* torsions) const {
    std::copy(setup_.torsions.begin(), setup_.torsions.end(), torsions);
  }

 private:
  Setup setup_;
  HybridEnergy energy_;
  std::unique_ptr<HybridEnergy> comparing_;  // for equal(), which is const, to compute with
  Conversion conversion_;
};

}  // namespace

HAPGRID_MODEL_PLUGIN(MoleculeModel, "a flexible molecule that a probe pushes and twists")
