#include "tools/apps/molecule/tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "tools/apps/molecule/elementary.hpp"

namespace hapgrid::molecule {

namespace {

// Below this sine of a bond angle (about 3° from a line) torsions about the bond are refused: a
// small change of the shape would turn them by a large angle.
constexpr double kMinSine = 0.05;

// An atom with a smaller sine between its two neighbours stands on a line, as those of an alkyne
// do.
constexpr double kStraight = 0.35;

using Neighbours = std::vector<std::vector<int>>;

double sine_between(const Positions& p, int a, int b, int c) {
  const Eigen::Vector3d u = (p[a] - p[b]).normalized(), v = (p[c] - p[b]).normalized();
  return u.cross(v).norm();
}

/// The neighbours of an atom that were not seen, and behind them the atoms of each line that begins
/// with one of them, up to the one at its end.
std::vector<int> reached(const Neighbours& neighbours, const std::vector<bool>& straight, int from,
                         const std::vector<bool>& seen) {
  std::vector<int> out, behind;
  for (const int next : neighbours[from]) {
    if (seen[next]) continue;
    out.push_back(next);
    for (int before = from, at = next; straight[at];) {
      const int after = neighbours[at][neighbours[at][0] == before ? 1 : 0];
      if (seen[after] || after == from) break;
      behind.push_back(after);
      before = std::exchange(at, after);
    }
  }
  for (const int atom : behind)
    if (std::find(out.begin(), out.end(), atom) == out.end()) out.push_back(atom);
  return out;
}

/// Whether each atom stands on a line between two that have other neighbours, somewhere on a path.
std::vector<bool> on_lines(const Neighbours& neighbours, const Molecule& molecule) {
  std::vector<bool> out;
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    const std::vector<int>& around = neighbours[i];
    const auto straight = [&](const Positions& p) {
      return sine_between(p, around[0], static_cast<int>(i), around[1]) < kStraight;
    };
    bool found = false;
    if (around.size() == 2 && neighbours[around[0]].size() > 1 &&
        neighbours[around[1]].size() > 1) {
      found = straight(molecule.conformation);
      for (const Path& path : molecule.paths)
        found = found || std::any_of(path.nodes.begin(), path.nodes.end(), straight);
    }
    out.push_back(found);
  }
  return out;
}

Tree breadth_first(const Neighbours& neighbours, const std::vector<bool>& straight, int root,
                   int& depth) {
  Tree tree;
  std::vector<int> level{0};
  std::vector<bool> seen(neighbours.size());
  seen[root] = true;
  tree.order = {root};
  tree.parent = {-1};
  tree.first_sibling = {0};
  for (std::size_t i = 0; i < tree.order.size(); ++i) {
    const int first = static_cast<int>(tree.order.size());
    for (const int next : reached(neighbours, straight, tree.order[i], seen)) {
      seen[next] = true;
      tree.order.push_back(next);
      tree.parent.push_back(static_cast<int>(i));
      tree.first_sibling.push_back(first);
      level.push_back(level[i] + 1);
    }
    tree.leaf.push_back(first == static_cast<int>(tree.order.size()));
  }
  depth = level.back();
  return tree;
}

std::string numbered(int atom) { return "atom " + std::to_string(atom + 1); }

}  // namespace

Tree spanning_tree(const Molecule& molecule) {
  Neighbours neighbours(molecule.atoms.size());
  for (const auto& [a, b] : molecule.bonds) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  }
  const std::vector<bool> straight = on_lines(neighbours, molecule);
  // Heavy atoms come first, since the siblings follow the first child. Lines come last, since the
  // root's first child spans its frame.
  for (std::vector<int>& list : neighbours)
    std::sort(list.begin(), list.end(), [&](int a, int b) {
      if (straight[a] != straight[b]) return static_cast<bool>(straight[b]);
      const bool light_a = molecule.atoms[a]->mass < 2, light_b = molecule.atoms[b]->mass < 2;
      return light_a != light_b ? light_b : a < b;
    });
  Tree best;
  int least_depth = std::numeric_limits<int>::max();
  for (std::size_t root = 0; root < neighbours.size(); ++root) {
    const std::vector<int>& around = neighbours[root];
    if (around.size() < 2 || straight[root] || straight[around[0]]) continue;
    if (sine_between(molecule.conformation, around[0], static_cast<int>(root), around[1]) <
        kMinSine)
      continue;
    int depth = 0;
    Tree tree = breadth_first(neighbours, straight, static_cast<int>(root), depth);
    if (depth >= least_depth) continue;
    least_depth = depth;
    best = std::move(tree);
  }
  if (best.order.empty())
    throw std::runtime_error("conformation: all atoms lie on a line, it has no torsions");
  return best;
}

Eigen::Matrix3d root_frame(const Tree& tree, const Positions& positions) {
  const Eigen::Vector3d& origin = positions[tree.order[0]];
  Eigen::Matrix3d frame;
  frame.col(0) = (positions[tree.order[1]] - origin).normalized();
  const Eigen::Vector3d second = positions[tree.order[2]] - origin;
  frame.col(1) = (second - frame.col(0) * frame.col(0).dot(second)).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

Internal internal_coordinates(const Tree& tree, const Positions& positions,
                              const Internal* reference, const std::string& where) {
  const std::size_t n = tree.size();
  Internal q{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  std::vector<Eigen::Matrix3d> frames(n);
  frames[0] = root_frame(tree, positions);
  for (std::size_t i = 1; i < n; ++i) {
    const Eigen::Matrix3d& from = frames[tree.parent[i]];
    const Eigen::Vector3d bond = positions[tree.order[i]] - positions[tree.order[tree.parent[i]]];
    q.length[i] = bond.norm();
    const Eigen::Vector3d d = from.transpose() * bond / q.length[i];
    const double sine = std::sqrt(d.y() * d.y() + d.z() * d.z());
    if (i > 1) q.deflection[i] = angle_of(sine, d.x());
    if (i > 2) q.torsion[i] = angle_of(d.z(), d.y());
    // A direction across the bond is needed for children, for siblings that follow, and for the
    // root's second child, which spans the root's frame.
    const bool followed = tree.first_sibling[i] == static_cast<int>(i) && i + 1 < n &&
                          tree.parent[i + 1] == tree.parent[i];
    if (i > 1 && sine < kMinSine && (!tree.leaf[i] || followed || i == 2)) {
      const int parent = tree.parent[i];
      const int before = parent > 0 ? tree.order[tree.parent[parent]] : tree.order[1];
      throw std::runtime_error(where + ": " + numbered(before) + ", " +
                               std::to_string(tree.order[parent] + 1) + " and " +
                               std::to_string(tree.order[i] + 1) +
                               " lie on a line, torsions there are not defined");
    }

    const int first = tree.first_sibling[i];
    if (first == static_cast<int>(i)) {
      if (reference) q.torsion[i] = unwrapped(q.torsion[i], reference->torsion[i]);
    } else {
      const double follows = reference ? reference->torsion[i] - reference->torsion[first] : 0;
      q.torsion[i] = q.torsion[first] + unwrapped(q.torsion[i] - q.torsion[first], follows);
    }

    Eigen::Matrix3d& frame = frames[i];
    frame.col(0) = d;
    if (i == 1) {
      frame = Eigen::Matrix3d::Identity();
    } else if (sine > 0) {
      frame.col(2) = Eigen::Vector3d(0, -d.z(), d.y()) / sine;
      frame.col(1) = frame.col(2).cross(frame.col(0));
    } else {
      frame.col(2) = Eigen::Vector3d(0, 0, 1);
      frame.col(1) = frame.col(2).cross(frame.col(0));
    }
    frame = from * frame;
  }
  return q;
}

}  // namespace hapgrid::molecule
