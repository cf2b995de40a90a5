// The energy between the atoms of a ligand whose bonds turn, as AutoDock 4 has it.
#pragma once

#include <array>
#include <vector>

#include "examples/docking/ligand.hpp"

namespace hapgrid::docking {

/// Two atoms of the ligand whose distance changes with a torsion. More than three bonds lie between
/// them.
class Pair {
 public:
  /// @throw std::runtime_error when AutoDock has no parameters for a type.
  Pair(const Ligand& ligand, std::size_t i, std::size_t j);

  /// Energy in kJ/mol and its first and second derivative by the distance r in angstrom. An energy
  /// E above `soft` is soft (1 + ln(E / soft)). Real-time safe.
  std::array<double, 3> energy(double r, double soft) const;

  std::size_t i, j;

 private:
  double repulsion_, attraction_, best_, charge_, desolvation_;
  int power_;  // of the attraction: 6, or 10 for a hydrogen bond
};

/// All such pairs with the torsions that the ligand has.
/// @throw std::runtime_error with one line
std::vector<Pair> pairs_of(const Ligand& ligand);

/// Numbers of the `count` torsions around which the energy changes least in a whole turn, with the
/// others as in the file.
/// @throw std::runtime_error with one line, when there are fewer.
std::vector<std::size_t> softest_torsions(const Ligand& ligand, std::size_t count, double soft);

}  // namespace hapgrid::docking
