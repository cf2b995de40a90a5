#include "tools/apps/molecule/setup.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <locale>
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

}  // namespace

Setup read_setup(PluginParameters& parameters) {
  Setup setup;
  // The minimiser was tried within these bounds. Beyond them a hand could feel nothing.
  read(parameters, "probe_radius", 0.1, 10, setup.energy.probe_radius);
  read(parameters, "penalty", 1, 1e5, setup.energy.penalty);
  read(parameters, "shift_stiffness", 0.1, 1e5, setup.energy.shift_stiffness);
  read(parameters, "rotation_stiffness", 0.1, 1e6, setup.energy.rotation_stiffness);
  read(parameters, "morph_stiffness", 0, 1e5, setup.energy.morph_stiffness);
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
  setup.molecule = read_molecule(conformation, transition_states, energies);
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
