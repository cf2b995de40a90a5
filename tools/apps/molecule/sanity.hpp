// Whether the paths of a molecule make sense, alone and together.
//
// The shapes on a path come from quantum chemistry. Nobody has computed those where paths are
// combined: where atoms run into each other there, one of the paths has to be left out.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "tools/apps/molecule/energy.hpp"

namespace hapgrid::molecule {

/// Two atoms at least three bonds apart.
struct AtomPair {
  double share = std::numeric_limits<double>::infinity();  ///< of the sum of their radii
  double distance = 0;                                     ///< Å
  std::size_t a = 0, b = 0;
  std::vector<double> t;  ///< where they are so near
};

/// What speaks against some paths, which are counted from 0: a path that misses its nodes, or atoms
/// that run into each other on one path, where two are combined, or where all are.
struct Problem {
  std::vector<std::size_t> paths;
  std::string what;

  /// "paths 1 and 2 combined: atoms overlap: ..."
  std::string line() const;
};

class Sanity {
 public:
  /// @param molecule, energy outlive this
  Sanity(const Molecule& molecule, HybridEnergy& energy);

  Positions shape(const std::vector<double>& t);
  /// The largest distance of a path's node from the morph's shape there, Å RMS.
  double worst_miss(std::size_t path);
  /// The nearest atoms on a path, where two are combined (on a lattice), and where all are.
  AtomPair nearest_on(std::size_t path);
  AtomPair nearest_on(std::size_t k, std::size_t l);
  AtomPair nearest_on_all();
  /// "C3 H14"
  std::string names(const AtomPair& pair) const;

  std::vector<Problem> problems();

 private:
  double place(std::size_t k, double share) const { return energy_.low(k) + share; }
  AtomPair nearest_pair(const std::vector<double>& t);
  void require(const AtomPair& pair, double least_share, std::vector<std::size_t> paths,
               std::vector<Problem>& problems) const;

  const Molecule& molecule_;
  HybridEnergy& energy_;
  std::vector<int> separation_;  // in bonds, atoms x atoms
};

}  // namespace hapgrid::molecule
