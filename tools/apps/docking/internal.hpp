// The energy between two atoms, as AutoDock 4 has it: of a ligand whose bonds turn, or of a ligand
// and its host.
#pragma once

#include <array>
#include <vector>

#include "tools/apps/docking/ligand.hpp"

namespace hapgrid::docking {

class Pair {
 public:
  /// @param i, j their numbers.
  /// @throw std::runtime_error when AutoDock has no parameters for a type.
  Pair(const Atom& a, const Atom& b, std::size_t i, std::size_t j);

  /// Energy in kJ/mol and its first and second derivative by the distance r in angstrom. An energy
  /// E above `soft` is soft (1 + ln(E / soft)). Real-time safe.
  std::array<double, 3> energy(double r, double soft = 1e300) const;

  std::size_t i, j;

 private:
  double repulsion_, attraction_, best_, charge_, desolvation_;
  int power_;  // of the attraction: 6, or 10 for a hydrogen bond
};

/// The pairs of the ligand's atoms whose distance changes with one of its torsions, and between
/// which more than three bonds lie.
/// @throw std::runtime_error with one line
std::vector<Pair> pairs_of(const Ligand& ligand);

/// Numbers of the `count` torsions around which the energy changes least in a whole turn, with the
/// others as in the file.
/// @throw std::runtime_error with one line, when there are fewer.
std::vector<std::size_t> softest_torsions(const Ligand& ligand, std::size_t count, double soft);

}  // namespace hapgrid::docking
