#include "tools/apps/molecule/setup.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <locale>
#include <numeric>
#include <set>
#include <sstream>
#include <stdexcept>

#include "examples/parameters.hpp"
#include "tools/apps/molecule/minima.hpp"

namespace hapgrid::molecule {

namespace {

void read(PluginParameters& parameters, const char* key, double least, double most, double& value) {
  value = parameters.number(key, value);
  if (!(value >= least && value <= most))
    refuse(key, value, "from " + decimal(least) + " to " + decimal(most));
}

/// "NAME A B C D", atoms from 1.
hapgrid_torsion read_torsion(const std::string& text, std::size_t atoms) {
  hapgrid_torsion torsion{};
  std::istringstream words(text);
  words.imbue(std::locale::classic());
  std::string name, rest;
  std::array<std::size_t, 4> numbers{};
  bool good = !!(words >> name) && name.size() < sizeof torsion.name;
  for (int k = 0; good && k < 4; ++k) {
    good = words >> numbers[k] && numbers[k] >= 1 && numbers[k] <= atoms;
    torsion.spheres[k] = static_cast<std::uint32_t>(numbers[k] - 1);
  }
  if (!good || words >> rest || std::set(numbers.begin(), numbers.end()).size() < 4)
    throw std::runtime_error("parameter torsions: '" + text +
                             "' is not like \"psi 5 7 9 15\": a name of at most 23 letters and "
                             "four of the atoms 1 to " +
                             std::to_string(atoms));
  std::copy(name.begin(), name.end(), torsion.name);
  return torsion;
}

/// Indices of atoms, from numbers that begin with 1.
std::vector<int> read_atoms(const char* key, const std::vector<double>& numbers,
                            std::size_t atoms) {
  std::vector<int> found;
  for (const double number : numbers) {
    if (!(number >= 1 && number <= static_cast<double>(atoms)) || number != std::floor(number))
      refuse(key, number, "the number of an atom, from 1 to " + std::to_string(atoms));
    found.push_back(static_cast<int>(number) - 1);
  }
  if (std::set(found.begin(), found.end()).size() < found.size())
    throw std::runtime_error(std::string("parameter ") + key + " has an atom twice");
  return found;
}

/// Whether these atoms say how the molecule is turned.
bool span_a_plane(const Positions& x, const std::vector<int>& atoms) {
  constexpr double kLeastArea = 0.1;  // Å², of a parallelogram
  for (const int b : atoms)
    for (const int c : atoms) {
      const Eigen::Vector3d one = x[b] - x[atoms[0]], other = x[c] - x[atoms[0]];
      if (one.cross(other).norm() > kLeastArea) return true;
    }
  return false;
}

}  // namespace

Setup read_setup(PluginParameters& parameters) {
  Setup setup;
  // The minimiser was tried within these bounds. Beyond them a hand could feel nothing.
  read(parameters, "probe_radius", 0.1, 10, setup.energy.probe_radius);
  read(parameters, "penalty", 1, 1e5, setup.energy.penalty);
  read(parameters, "shift_stiffness", 0.1, 1e5, setup.energy.shift_stiffness);
  read(parameters, "rotation_stiffness", 0.1, 1e6, setup.energy.rotation_stiffness);
  read(parameters, "morph_stiffness", 0, 1e5, setup.energy.morph_stiffness);
  read(parameters, "hold_force", 0.1, 1e4, setup.energy.hold_force);
  read(parameters, "hold_width", 0.01, 10, setup.energy.hold_width);
  const std::vector<double> hold = parameters.numbers("hold"), fixed = parameters.numbers("fixed");
  double bonds_change = 0;
  read(parameters, "bonds_change", 0, 1, bonds_change);
  read(parameters, "substep", 0.001, 1, setup.substep);
  read(parameters, "tolerance", 1e-3, 1, setup.tolerance);
  read(parameters, "force_scale", 1e-9, 1e3, setup.force_scale);
  const std::string conformation = parameters.text("conformation", "");
  const std::vector<std::string> transition_states = parameters.texts("transition_states");
  const std::vector<double> energies = parameters.numbers("energies");
  const std::vector<std::string> torsions = parameters.texts("torsions");
  parameters.finish();
  if (conformation.empty())
    throw std::runtime_error("parameter conformation is missing: an XYZ text");
  setup.molecule = read_molecule(conformation, transition_states, energies, bonds_change != 0);
  Molecule& molecule = setup.molecule;
  setup.energy.hold = read_atoms("hold", hold, molecule.atoms.size());
  molecule.fixed = read_atoms("fixed", fixed, molecule.atoms.size());
  if (!fixed.empty() && !span_a_plane(molecule.conformation, molecule.fixed))
    throw std::runtime_error("parameter fixed: its atoms lie on a line, which could turn");
  std::vector<int> all(molecule.atoms.size());
  std::iota(all.begin(), all.end(), 0);
  if (molecule.bonds_change && !span_a_plane(molecule.conformation, all))
    throw std::runtime_error("conformation: all atoms lie on a line, which could turn");
  for (const std::string& text : torsions)
    setup.torsions.push_back(read_torsion(text, setup.molecule.atoms.size()));
  for (const Path& path : setup.molecule.paths)
    if (path.beyond() && setup.energy.morph_stiffness != 0)
      refuse("morph_stiffness", setup.energy.morph_stiffness,
             "0 where a path goes on behind its saddles: it would lift the minima there");
  if (combined_minima(setup.molecule).size() > kMaxMinima)
    throw std::runtime_error("transition_states: their minima combine to more than " +
                             std::to_string(kMaxMinima) + " shapes");
  return setup;
}

}  // namespace hapgrid::molecule
