// A ligand: the atoms of a PDBQT file around their centre, the bonds that turn, and the turns that
// carry it into itself.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "tools/apps/table/lattice.hpp"

namespace hapgrid::docking {

using table::cross, table::dot, table::length, table::minus, table::Vector;
using Matrix = std::array<Vector, 3>;  ///< rows

struct Atom {
  std::string type;  ///< AutoDock's: "C", "A", "OA", "HD", ...
  double charge = 0;
  Vector place;  ///< angstrom; of a ligand's atom in the file, from the centre
};

/// A bond around which some of the atoms turn.
struct Torsion {
  std::size_t from = 0, to = 0;    ///< the atoms of the bond, the first one nearer to the root
  std::vector<std::size_t> moved;  ///< the atoms beyond `to`
  /// The angle in radians after which atoms of the same type and charge lie where they lay.
  double period = 0;
};

inline constexpr double kJoule = 4.184;  ///< kJ in a kcal, the unit of maps and of AutoDock
inline constexpr std::size_t kMostAtoms = 200, kMostTorsions = 6;  // of a ligand
inline constexpr std::size_t kMostHostAtoms = 500;                 // of a host without maps

struct Ligand {
  std::vector<Atom> atoms;
  /// The bonds that turn. The atoms beyond one of them are beyond an earlier one as well, or none
  /// of them is.
  std::vector<Torsion> torsions;
  /// The turns that bring each atom to one of its type, charge and place; the first leaves all as
  /// they are. With torsions there is no other: a turn that carries one shape of the ligand into
  /// itself does not carry the next.
  std::vector<Matrix> symmetry;
  Vector axis{};  ///< of length 1, when all atoms lie on one line, around which nothing turns

  std::size_t state_size() const { return 6 + torsions.size(); }

  /// The places of all atoms around their centre with the torsions at these angles in radians, 0
  /// being the file's. Real-time safe.
  void bend(const double* angles, Vector* places) const;

  /// The RMS distance of the atoms between two states (two columns of a rotation matrix, and the
  /// angles of the torsions), the smallest over the symmetry.
  double distance(const double* a, const double* b) const;
};

/// The atoms of a PDBQT text, and all bonds that it says turn.
/// @throw std::runtime_error with one line
Ligand read_ligand(const std::string& pdbqt);

/// The atoms of a host's PDBQT text.
/// @throw std::runtime_error with one line
std::vector<Atom> read_host(const std::string& pdbqt);

/// Leaves the ligand those of its torsions whose numbers these are, in ascending order, and finds
/// what is the same then.
void keep_torsions(Ligand& ligand, const std::vector<std::size_t>& numbers);

/// The symbol of the element of one of AutoDock's types.
std::string element_of(const std::string& type);

}  // namespace hapgrid::docking
