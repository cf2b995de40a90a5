#include "tools/apps/molecule/sanity.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <random>

namespace hapgrid::molecule {

namespace {

// Atoms three bonds apart or more that are nearer than this share of the sum of their radii overlap
// more than in any molecule.
constexpr double kMinShareOnPath = 0.55;
constexpr double kMinShareCombined = 0.4;
// Where more than two paths are combined: all corners of the cube of t while they are few, and
// random places.
constexpr std::size_t kMaxCornerPaths = 10;
constexpr int kRandomPlaces = 4000;
// How far the morph may be from a node, Å RMS: numbers are rounded, and the conformation has a file
// of its own.
constexpr double kMaxMiss = 1e-6;

void keep_nearer(AtomPair& nearest, AtomPair&& pair) {
  // Where no two atoms are three bonds apart each pair is as far as the first.
  if (nearest.t.empty() || pair.share < nearest.share) nearest = std::move(pair);
}

}  // namespace

Sanity::Sanity(const Molecule& molecule, HybridEnergy& energy)
    : molecule_(molecule), energy_(energy) {
  const std::size_t n = molecule.atoms.size();
  separation_.assign(n * n, static_cast<int>(n));
  for (std::size_t i = 0; i < n; ++i) separation_[i * n + i] = 0;
  for (const auto& [a, b] : molecule.bonds) separation_[a * n + b] = separation_[b * n + a] = 1;
  for (std::size_t k = 0; k < n; ++k)  // Floyd and Warshall
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        separation_[i * n + j] =
            std::min(separation_[i * n + j], separation_[i * n + k] + separation_[k * n + j]);
}

Positions Sanity::shape(const std::vector<double>& t) {
  std::vector<double> s = t;
  s.resize(energy_.variables());
  std::vector<double> p(3 * molecule_.atoms.size());
  energy_.positions(s.data(), p.data());
  Positions positions;
  for (std::size_t i = 0; i < p.size(); i += 3) positions.emplace_back(p[i], p[i + 1], p[i + 2]);
  return positions;
}

/// The node at t = 0 is the conformation, which has a text of its own.
double Sanity::worst_miss(std::size_t k) {
  const Path& path = molecule_.paths[k];
  double worst =
      aligned_rmsd(shape(std::vector<double>(molecule_.paths.size())), molecule_.conformation);
  for (std::size_t m = 0; m < path.nodes.size(); ++m) {
    if (m == path.start) continue;
    std::vector<double> t(molecule_.paths.size());
    t[k] = path.t(m);
    worst = std::max(worst, aligned_rmsd(shape(t), path.nodes[m]));
  }
  return worst;
}

AtomPair Sanity::nearest_pair(const std::vector<double>& t) {
  const Positions p = shape(t);
  const std::size_t n = p.size();
  AtomPair nearest;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) {
      if (separation_[a * n + b] < 3) continue;
      const double distance = (p[a] - p[b]).norm();
      const double share = distance / (molecule_.atoms[a]->radius + molecule_.atoms[b]->radius);
      if (share < nearest.share) nearest = {share, distance, a, b, {}};
    }
  nearest.t = t;
  return nearest;
}

AtomPair Sanity::nearest_on(std::size_t path) {
  AtomPair nearest;
  for (int step = 0; step <= 100; ++step) {
    std::vector<double> t(molecule_.paths.size());
    t[path] = place(path, step / 100.0);
    keep_nearer(nearest, nearest_pair(t));
  }
  return nearest;
}

AtomPair Sanity::nearest_on(std::size_t k, std::size_t l) {
  AtomPair nearest;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j) {
      std::vector<double> t(molecule_.paths.size());
      t[k] = place(k, i / 10.0);
      t[l] = place(l, j / 10.0);
      keep_nearer(nearest, nearest_pair(t));
    }
  return nearest;
}

/// Half of the random places are on faces of the cube, where a molecule that is pushed hard is.
AtomPair Sanity::nearest_on_all() {
  const std::size_t paths = molecule_.paths.size();
  AtomPair nearest;
  const std::size_t corner_paths = std::min(paths, kMaxCornerPaths);
  for (unsigned corner = 0; corner < 1U << corner_paths; ++corner) {
    std::vector<double> t(paths);
    for (std::size_t k = 0; k < paths; ++k) t[k] = place(k, k < corner_paths ? corner >> k & 1 : 1);
    keep_nearer(nearest, nearest_pair(t));
  }
  std::mt19937 random(1);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  for (int draw = 0; draw < kRandomPlaces; ++draw) {
    std::vector<double> t(paths);
    for (std::size_t k = 0; k < paths; ++k)
      t[k] = place(k, draw % 2 == 0 ? uniform() : std::clamp(2 * uniform() - 0.5, 0.0, 1.0));
    keep_nearer(nearest, nearest_pair(t));
  }
  return nearest;
}

std::string Sanity::names(const AtomPair& pair) const {
  const auto name = [this](std::size_t atom) {
    return molecule_.atoms[atom]->symbol + std::to_string(atom + 1);
  };
  return name(pair.a) + " " + name(pair.b);
}

std::string Problem::line() const {
  const std::string first = std::to_string(paths.at(0));
  const std::string where =
      paths.size() == 1   ? "path " + first
      : paths.size() == 2 ? "paths " + first + " and " + std::to_string(paths[1]) + " combined"
                          : "all paths combined";
  return where + ": " + what;
}

void Sanity::require(const AtomPair& pair, double least_share, std::vector<std::size_t> paths,
                     std::vector<Problem>& problems) const {
  if (pair.share >= least_share) return;
  char share[100];
  std::snprintf(share, sizeof share, "nearer than %g of the sum of their radii (%.2f, %.2f Å",
                least_share, pair.share, pair.distance);
  std::string at;
  for (const double t : pair.t) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.2g", at.empty() ? "" : ", ", t);
    at += number;
  }
  problems.push_back({std::move(paths), "atoms overlap: " + names(pair) + " are " + share +
                                            ", at t = " + at + "); leave a path out"});
}

std::vector<Problem> Sanity::problems() {
  std::vector<Problem> found;
  const std::size_t paths = molecule_.paths.size();
  for (std::size_t k = 0; k < paths; ++k) {
    if (worst_miss(k) > kMaxMiss)
      found.push_back(
          {{k}, "it misses its nodes: the shapes in its file do not follow each other"});
    require(nearest_on(k), kMinShareOnPath, {k}, found);
  }
  if (molecule_.bonds_change) return found;  // the molecule is on one path at a time
  for (std::size_t k = 0; k < paths; ++k)
    for (std::size_t l = k + 1; l < paths; ++l)
      require(nearest_on(k, l), kMinShareCombined, {k, l}, found);
  if (paths > 2) {
    std::vector<std::size_t> all(paths);
    std::iota(all.begin(), all.end(), 0);
    require(nearest_on_all(), kMinShareCombined, std::move(all), found);
  }
  return found;
}

}  // namespace hapgrid::molecule
