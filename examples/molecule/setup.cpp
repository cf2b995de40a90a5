#include "examples/molecule/setup.hpp"

#include <stdexcept>

#include "examples/molecule/minima.hpp"
#include "examples/parameters.hpp"

namespace hapgrid::molecule {

namespace {

void read(PluginParameters& parameters, const char* key, double least, double most, double& value) {
  value = parameters.number(key, value);
  if (!(value >= least && value <= most))
    refuse(key, value, "from " + decimal(least) + " to " + decimal(most));
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
  parameters.finish();
  if (conformation.empty())
    throw std::runtime_error("parameter conformation is missing: a text in XYZ or SDF format");
  setup.molecule = read_molecule(conformation, transition_states, energies);
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
