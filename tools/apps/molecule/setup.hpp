// The model's parameters, as a MODEL.toml gives them.
#pragma once

#include <hapgrid/plugin.hpp>

#include "tools/apps/molecule/energy.hpp"
#include "tools/apps/molecule/input.hpp"

namespace hapgrid::molecule {

/// [model.files] / [model.parameters]:
///   conformation         XYZ text with one frame: the minimum
///   transition_states    texts: one frame, or the nodes of a path from the conformation, or of one
///                        that goes on behind its saddles and has the conformation inside; without
///                        any the molecule keeps its shape, and a state is shift and rotation
///   energies             kJ/mol of the transition states above the conformation; by default those
///                        that the texts give
///   probe_radius         Å, default 1.2
///   penalty              kJ/(mol Å²), default 100: stiffness of an atom that the probe overlaps
///   hold                 atoms from 1 whose centre the hand holds by a tie, instead of pushing
///   with
///                        the probe; default none
///   hold_force           kJ/(mol Å), default 40: the tie never pulls stronger
///   hold_width           Å, default 0.5: near its atom the tie is a spring of hold_force /
///   hold_width fixed                atoms from 1, at least three that lie on no line, which stay
///   in their place
///                        while the shape changes; default none: the molecule stays by its mass
///   shift_stiffness      kJ/(mol Å²), default 20: holds the molecule in its place
///   rotation_stiffness   kJ/(mol rad²), default 100: holds the molecule in its orientation
///   morph_stiffness      kJ/mol, default 5: m in a stabiliser ½ m t² for each t, which is no part
///                        of the molecule's energy; must be 0 where a path goes on
///                        behind its saddles
///   substep              Å, default 0.05: the HIP's longest move between two minimisations
///   tolerance            Å, default 0.1: states are equal when their atoms are no farther apart,
///                        RMS
///   torsions             texts such as "psi 5 7 9 15", which pictures name and follow: a name of
///   at
///                        most 23 letters and four atoms by their numbers in the file, from 1
///   force_scale          N per kJ/(mol Å), default 0.025: newtons at the device for the force
struct Setup {
  EnergyParameters energy;
  double substep = 0.05;
  double tolerance = 0.1;
  double force_scale = 0.025;
  Molecule molecule;
  std::vector<hapgrid_torsion> torsions;
};

/// @throw std::runtime_error with one line that names the parameter.
Setup read_setup(PluginParameters& parameters);

}  // namespace hapgrid::molecule
