// Internal coordinates along a spanning tree of the bonds: what the morph interpolates.
//
// If positions were interpolated, bonds would become shorter wherever a group rotates; internal
// coordinates keep their lengths. Every molecule has a spanning tree, also one with rings: a bond
// that closes a ring is not in the tree, and it keeps its length as far as both ends move together.
// Atoms on a line, as those of an alkyne, and the atom behind them are all children of the atom
// before the line: about a line that bends to either side no torsion is defined.
//
// Each atom has a frame of axes, x along the bond from its parent. A child is reached by turning
// about x by the torsion, then about z by the deflection (180° less the bond angle), and then going
// the bond's length along the new x. This needs no division, and no torsion measured from
// positions.
#pragma once

#include <string>
#include <vector>

#include "tools/apps/molecule/input.hpp"

namespace hapgrid::molecule {

struct Tree {
  std::vector<int> order;   // atoms, parents before their children; order[0] is the root
  std::vector<int> parent;  // place in `order` of the parent; -1 for the root
  /// Place in `order` of the first child of the same parent, which may be the atom itself. The
  /// other children's torsions are followed relative to the first one's, since siblings turn
  /// together.
  std::vector<int> first_sibling;
  std::vector<bool> leaf;

  std::size_t size() const { return order.size(); }
};

/// Bond lengths (Å), deflections and torsions (rad) by place in the tree's order. Entry 0, the
/// root, is 0, and so are the deflection of the root's first child and the torsions of its first
/// two: they would turn the molecule as a whole.
struct Internal {
  std::vector<double> length, deflection, torsion;
};

/// The tree is built breadth first. Its root is the atom that makes it least deep.
/// @throw std::runtime_error when every atom that could be the root lies on a line with its
/// neighbours.
Tree spanning_tree(const Molecule& molecule);

/// The frame of the root, to which internal coordinates refer: x points to the first child, and the
/// second child lies in the half-plane of positive y.
Eigen::Matrix3d root_frame(const Tree& tree, const Positions& positions);

/// Internal coordinates of a shape. Of the angles that differ by multiples of 2π, torsions are
/// those nearest to `reference`; without it, those of first siblings are in [-π, π] and others
/// within π of their first sibling's.
/// @throw std::runtime_error "WHERE: ..." when torsions are not defined, because three atoms in a
/// row lie on a line.
Internal internal_coordinates(const Tree& tree, const Positions& positions,
                              const Internal* reference, const std::string& where);

}  // namespace hapgrid::molecule
