// Reads a molecule, its conformation and its paths to transition states from XYZ texts.
// Whatever could make the morph wrong is refused here.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tools/apps/molecule/elements.hpp"

namespace hapgrid::molecule {

/// One shape: the position of each atom, Å.
using Positions = std::vector<Eigen::Vector3d>;

/// The path from the conformation (t = 0) to a transition state (t = 1), at equidistant t; or one
/// that goes on through its saddles, with the conformation at any node and t from low() to low()
/// + 1.
struct Path {
  std::vector<Positions> nodes;  // at least 2; nodes[start] is the conformation as that file has it
  std::vector<double> energies;  // kJ/mol above the conformation, one a node; 0 at the start
  std::size_t start = 0;
  std::vector<std::size_t> minima;  // nodes that are minima behind saddles, ascending
  bool closes = false;  // the last node is the first one once more, after a turn that led round

  /// The t of a node.
  double t(std::size_t node) const {
    return (static_cast<double>(node) - static_cast<double>(start)) /
           static_cast<double>(nodes.size() - 1);
  }
  double low() const { return t(0); }
  /// Whether it is more than a path to a transition state.
  bool beyond() const { return start > 0 || !minima.empty(); }
};

struct Molecule {
  std::vector<const Element*> atoms;
  std::vector<std::pair<int, int>> bonds;  // indices into atoms, each pair ascending, sorted
  /// Whether bonds break and form on the paths: `bonds` has those of all frames, and of several
  /// paths the molecule is on one at a time.
  bool bonds_change = false;
  Positions conformation;
  std::vector<int> fixed;   // atoms that stay in their place while the shape changes; none: the
                            // molecule stays as a whole, by its mass
  std::vector<Path> paths;  // none: the molecule keeps its shape
};

/// How far a path's node at t = 0 may be from the conformation after alignment, Å RMS.
inline constexpr double kMaxFirstNodeRmsd = 0.02;
/// How far apart the ends of a path may be that closes, Å RMS: they are one shape, in a file's
/// digits.
inline constexpr double kMaxEndsRmsd = 1e-6;
/// How far below the conformation a node may lie, kJ/mol: optimisations converge no better. Where a
/// node lies lower with no saddle between, the conformation is no minimum.
inline constexpr double kMaxEnergyBelow = 0.1;
/// A minimum behind a saddle is deeper than this, kJ/mol; a dent in a path is none.
inline constexpr double kMinDepth = 1;
/// How far "dE=" and "E=" of a title may differ, kJ/mol: the former may be rounded to one decimal.
inline constexpr double kMaxEnergiesDiffer = 0.06;
/// The least distance of two atoms in a shape, Å.
inline constexpr double kMinDistance = 0.5;

/// @param conformation one frame. Bonds are found by distances.
/// @param transition_states one text for each transition state, with one frame or with the nodes of
/// the path, one of which is the conformation; may be empty. A frame's title gives its energy:
/// "dE=" in kJ/mol above the conformation, or "E=" or "energy:" in hartree where the conformation's
/// title has that, too. Where it gives both they must agree.
/// @param energies the energies of the transition states, kJ/mol, instead of those that their last
/// frames give; may be empty
/// @param bonds_change the frames may have other bonds than the conformation, and be of several
/// molecules
/// @throw std::runtime_error with one line that names the text, the frame and the atoms.
Molecule read_molecule(const std::string& conformation,
                       const std::vector<std::string>& transition_states,
                       const std::vector<double>& energies, bool bonds_change = false);

/// The least RMS distance of two shapes over all rotations and translations, Å (W. Kabsch, Acta
/// Cryst. A32 (1976) 922). A mirror image is another shape.
double aligned_rmsd(const Positions& a, const Positions& b);

}  // namespace hapgrid::molecule
