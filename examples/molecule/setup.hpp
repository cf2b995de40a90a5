// The model's parameters, as a MODEL.toml gives them.
#pragma once

#include "examples/molecule/energy.hpp"
#include "examples/molecule/input.hpp"
#include "libcore/model/plugin.hpp"

namespace hapgrid::molecule {

/// [model.files] / [model.parameters]:
///   conformation         text of an XYZ or SDF file with one frame: the minimum
///   transition_states    texts: one frame, or the nodes of a path from the conformation
///   energies             kJ/mol of the transition states above the conformation; default: as the
///                        texts say
///   probe_radius         Å, default 1.2
///   penalty              kJ/(mol Å²), default 100: of the probe's overlap with an atom
///   shift_stiffness      kJ/(mol Å²), default 20: holds the molecule in its place
///   rotation_stiffness   kJ/(mol rad²), default 100: and in its orientation
///   morph_stiffness      kJ/mol, default 0: a stabiliser ½ m t² for each t; no part of the
///                        molecule's energy
///   substep              Å, default 0.05: of the HIP between two minimisations
///   tolerance            Å, default 0.1: states whose atoms are no farther apart, RMS, are one
///   force_scale          N per kJ/(mol Å), default 0.025: what the device shows of the force
struct Setup {
  EnergyParameters energy;
  double substep = 0.05;
  double tolerance = 0.1;
  double force_scale = 0.025;
  Molecule molecule;
};

/// @throw std::runtime_error with one line that names the parameter.
Setup read_setup(PluginParameters& parameters);

}  // namespace hapgrid::molecule
