// A molecule, its conformation and its ways to transition states, read from texts in XYZ or SDF
// format with Open Babel and checked: whatever could make the morph wrong is refused here.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "examples/molecule/elements.hpp"

namespace hapgrid::molecule {

/// One shape: positions in Å, an atom a row.
using Positions = std::vector<Eigen::Vector3d>;

/// The way from the conformation (t = 0) to a transition state (t = 1), at equidistant t.
struct Path {
  std::vector<Positions> nodes;  // at least 2; the first is the conformation as that file has it
  std::vector<double> energies;  // kJ/mol above the conformation, one a node; the first is 0
};

struct Molecule {
  std::vector<const Element*> atoms;
  std::vector<std::pair<int, int>> bonds;  // indices into atoms, each pair ascending, sorted
  Positions conformation;
  std::vector<Path> paths;
};

/// A path's first node may differ from the conformation by this much after alignment, Å RMS.
inline constexpr double kMaxFirstNodeRmsd = 0.02;
/// How far below the conformation a node may lie, kJ/mol: what is left of an optimisation's
/// convergence. More says that the conformation is no minimum.
inline constexpr double kMaxEnergyBelow = 0.1;
/// Two atoms of a shape that are not this far apart, Å, overlap.
inline constexpr double kMinDistance = 0.5;

/// @param conformation one frame. Its bonds are those that the text gives (SDF), else those that
/// Open Babel perceives from distances.
/// @param transition_states one text a transition state: one frame, or the nodes of a path.
/// Energies are taken from a frame's title: "dE=" in kJ/mol above the conformation, else "E=" or
/// "energy:" in hartree.
/// @param energies if not empty the energies of the transition states, kJ/mol, in place of what
/// their last frames say.
/// @throw std::runtime_error with one line that names the text, the frame and the atoms.
Molecule read_molecule(const std::string& conformation,
                       const std::vector<std::string>& transition_states,
                       const std::vector<double>& energies);

/// Least RMS distance of two shapes over rotations and translations, Å (W. Kabsch, Acta Cryst. A32
/// (1976) 922); mirror images stay apart.
double aligned_rmsd(const Positions& a, const Positions& b);

}  // namespace hapgrid::molecule
