// Internal coordinates along a spanning tree of the bonds: what the morph interpolates.
//
// Interpolating positions would shorten bonds wherever something rotates; internal coordinates keep
// them. A spanning tree takes every molecule, rings too: a bond that closes a ring is just not in
// the tree, and stays closed as far as both ends move together.
//
// Each atom carries a frame, its x-axis along the bond from its parent. A child is reached by
// turning about x by the torsion, then about z by the deflection (180° less the bond angle), then
// walking the bond's length along the new x. So there is no division on the way and no torsion to
// be measured from positions.
#pragma once

#include <string>
#include <vector>

#include "examples/molecule/input.hpp"

namespace hapgrid::molecule {

struct Tree {
  std::vector<int> order;   // atoms, parents before their children; order[0] is the root
  std::vector<int> parent;  // place in `order` of the parent; -1 for the root
  /// Place in `order` of the first child of the same parent (itself for that). The torsions of the
  /// others are followed relative to it: siblings turn together.
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

/// Breadth first from the atom from which the farthest one is nearest.
/// @throw std::runtime_error when every atom that could be the root lies on a line with its
/// neighbours.
Tree spanning_tree(const Molecule& molecule);

/// The frame of the root that internal coordinates refer to: x to the first child, the second one
/// in the half-plane of positive y.
Eigen::Matrix3d root_frame(const Tree& tree, const Positions& positions);

/// Internal coordinates of a shape; torsions lie as near as possible to those of `reference`, or,
/// without one, those of first siblings in [-π, π] and others within π of their first sibling's.
/// @throw std::runtime_error "WHERE: ..." when torsions are not defined, because three atoms in a
/// row lie on a line.
Internal internal_coordinates(const Tree& tree, const Positions& positions,
                              const Internal* reference, const std::string& where);

}  // namespace hapgrid::molecule
