// The energy of a ligand in its host, and how its orientation comes to rest.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/apps/docking/internal.hpp"
#include "tools/apps/docking/ligand.hpp"
#include "tools/apps/table/lattice.hpp"
#include "tools/apps/table/spline.hpp"

namespace hapgrid::docking {

/// The energy of an atom is AutoDock 4's (Huey et al., J. Comput. Chem. 28, 1145, 2007). By maps,
/// that of an atom of type t and charge q is map t + q map e + |q| map d. Inside the host it grows
/// to 1e5 kcal/mol and more, over which a spline would swing. So its height above 5 kJ/mol below
/// the lowest value is e to the power of a tricubic spline: the logarithm of a repulsion is a flat
/// curve. Without maps the energy is the sum over the host's atoms. An energy E above `soft`
/// becomes soft (1 + ln(E / soft)). So does the sum over the atoms, to which the energies of the
/// ligand's pairs belong when it has torsions.
class Poses {
 public:
  /// @param maps one for each name; `names` are the atoms' types, and e and d.
  /// @param soft in kJ/mol, positive
  /// @throw std::runtime_error with one line
  Poses(Ligand ligand, const std::vector<std::string>& names,
        const std::vector<table::Lattice>& maps, double soft);
  /// @param host its atoms
  Poses(Ligand ligand, std::vector<Atom> host, double soft);

  const Ligand& ligand() const { return ligand_; }

  /// kJ/mol, with the ligand's centre at x in the state s: two columns of a rotation matrix, then
  /// the angles of the torsions. `gradient`, when it is not null, gets the derivative by x.
  /// Real-time safe.
  double energy(const double* x, const double* s, double* gradient) const;

  /// Turns s and its torsions downhill to the next minimum, in steps that cannot jump over a
  /// barrier.
  /// @throw std::runtime_error when it does not come to rest
  void relax(const double* x, double* s) const;

  /// Of the orientations that the symmetry makes the same, writes that into s which is nearest to
  /// the ligand's in its file, so that the same pose mostly has the same numbers. A ligand on one
  /// line gets the shortest turn. Angles are brought within half a period of 0.
  void choose(double* s) const;

  /// The places of the atoms. Real-time safe.
  void places(const double* x, const double* s, Vector* places) const;

 private:
  static constexpr std::size_t kMost = 3 + kMostTorsions;
  struct Torque {
    double energy = 0;
    std::array<double, kMost> slope{};  // by a turn of the ligand and of its torsions, kJ/(mol rad)
    std::array<std::array<double, kMost>, kMost> bend{};  // the lower half
  };
  Torque torque(const double* x, const double* s) const;
  /// Of one atom of the ligand in the host. Derivatives are by x, y and z.
  table::Spline::Value alone(std::size_t atom, const Vector& place, bool with_hessian) const;
  table::Spline::Value among_atoms(std::size_t atom, const Vector& place) const;
  /// How the turns move the atoms: the derivatives of their places. arms: from the centre to them.
  void find_motions(const Vector* arms, std::array<Vector, kMost>* motions, Vector* axes) const;
  void add_curvature(const Vector* arms, const std::array<Vector, kMost>* motions,
                     const Vector* axes, const Vector* g, Torque& out) const;

  Ligand ligand_;
  std::vector<Pair> pairs_;
  std::vector<Atom> host_;                     // none where there are maps
  std::vector<std::vector<Pair>> host_pairs_;  // of each atom of the ligand with those of the host
  table::Lattice lattice_;                     // without values
  std::vector<table::Spline> splines_;         // of each kind of atom: ln(energy - base)
  std::vector<double> base_;                   // of each kind of atom, kJ/mol
  std::vector<std::size_t> kind_;              // of each atom
  double soft_;
};

}  // namespace hapgrid::docking
