// A flexible molecule that a probe ball pushes and twists (Sect. 3 of the paper), or of which the
// hand holds an atom: the plug-in.
#include <array>
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
// The radius of the ball that pictures show where the hand holds an atom, Å.
constexpr double kHandle = 0.3;

class MoleculeModel {
 public:
  explicit MoleculeModel(hapgrid::PluginParameters& parameters)
      : setup_(read_setup(parameters)),
        energy_(setup_.molecule, setup_.energy),
        comparing_(std::make_unique<HybridEnergy>(energy_)),
        conversion_(std::make_unique<Conversion>(setup_.molecule, energy_, setup_.substep,
                                                 MinimiserLimits())) {}

  hapgrid_model_info info() const {
    hapgrid_model_info info{};
    info.state_size = static_cast<std::uint32_t>(energy_.variables());
    info.d_max = kMaxShift;
    info.tolerance = setup_.tolerance;
    std::snprintf(info.tolerance_unit, sizeof info.tolerance_unit, "angstrom RMSD");
    std::snprintf(info.length_unit, sizeof info.length_unit, "angstrom");
    std::snprintf(info.energy_unit, sizeof info.energy_unit, "kJ/mol");
    info.force_scale = setup_.force_scale;
    info.hip_radius = setup_.energy.hold.empty() ? setup_.energy.probe_radius : kHandle;
    info.spheres = static_cast<std::uint32_t>(setup_.molecule.atoms.size());
    info.torsions = static_cast<std::uint32_t>(setup_.torsions.size());
    return info;
  }

  std::vector<double> known_states(const double* x) const {
    const Minima& minima = conversion_->minima();
    std::vector<double> known;
    if (!setup_.energy.hold.empty()) return pulled_to(x);
    for (std::size_t m = 0; m < minima.size(); ++m)
      if (!minima.touched(m, x))
        known.insert(known.end(), minima.state(m).begin(), minima.state(m).end());
    return known;
  }

  void convert(const double* s, const double* x, const double* d, double* result) {
    conversion_->convert(s, x, d, result);
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

  void periods(double* periods) const {
    for (std::size_t k = 0; k < setup_.molecule.paths.size(); ++k) periods[k] = energy_.closes(k);
  }

  void torsions(hapgrid_torsion* torsions) const {
    std::copy(setup_.torsions.begin(), setup_.torsions.end(), torsions);
  }

 private:
  /// What is held is never at rest: in each minimum it is taken where it is, and pulled to x.
  std::vector<double> pulled_to(const double* x) const {
    const Minima& minima = conversion_->minima();
    std::vector<double> known, state(energy_.variables());
    for (std::size_t m = 0; m < minima.size(); ++m) {
      const std::array<double, 3> at = minima.centre(m, setup_.energy.hold);
      const double d[3] = {x[0] - at[0], x[1] - at[1], x[2] - at[2]};
      conversion_->convert(minima.state(m).data(), at.data(), d, state.data());
      bool is_new = true;
      for (std::size_t k = 0; k < known.size(); k += state.size())
        is_new = is_new && !equal(&known[k], state.data());
      if (is_new) known.insert(known.end(), state.begin(), state.end());
    }
    return known;
  }

  Setup setup_;
  HybridEnergy energy_;
  std::unique_ptr<HybridEnergy> comparing_;  // for equal(), which is const, to compute with
  std::unique_ptr<Conversion> conversion_;
};

}  // namespace

HAPGRID_MODEL_PLUGIN(
    MoleculeModel,
    "a flexible molecule that a probe pushes and twists, or of which the hand holds an atom")
