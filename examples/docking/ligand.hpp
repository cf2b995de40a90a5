// A rigid ligand: the atoms of a PDBQT file around their centre, and the turns that carry it into
// itself.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace hapgrid::docking {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;  ///< rows

struct LigandAtom {
  std::string type;  ///< AutoDock's: "C", "A", "OA", "HD", ...
  double charge = 0;
  Vector place;  ///< from the centre, angstrom
};

struct Ligand {
  std::vector<LigandAtom> atoms;
  Vector centre;      ///< of the atoms in the file, angstrom
  double radius = 0;  ///< of the farthest atom from the centre
  Matrix spread{};    ///< the sum of b b^T over the atoms' places b
  /// The turns that bring each atom to one of its type, charge and place; the first leaves all as
  /// they are.
  std::vector<Matrix> symmetry;
  Vector axis{};  ///< of length 1, when all atoms lie on one line, around which nothing turns

  /// The RMS distance of the atoms between two orientations (two columns of a rotation matrix
  /// each), the smallest over the symmetry.
  double distance(const double* a, const double* b) const;
};

inline constexpr std::size_t kMostAtoms = 200;

/// The atoms of a PDBQT text. @throw std::runtime_error with one line
Ligand read_ligand(const std::string& pdbqt);

/// The symbol of the element of one of AutoDock's types.
std::string element_of(const std::string& type);

}  // namespace hapgrid::docking
