#include "tools/apps/docking/internal.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace hapgrid::docking {

namespace {

// The force field of AutoDock 4 (Huey et al., J. Comput. Chem. 28, 1145, 2007; parameters AD4.1).
constexpr double kVanDerWaals = 0.1662, kHydrogenBond = 0.1209, kElectrostatic = 0.1406,
                 kDesolvation = 0.1322;
constexpr double kCoulomb = 332.06363;  // kcal angstrom / (mol e^2)
constexpr double kChargeSolvation = 0.01097;
constexpr double kSigma = 3.6;    // angstrom, of the desolvation
constexpr double kSmooth = 0.25;  // angstrom: the minimum is so wide to each side

enum Hydrogen { kNone, kDonor, kAcceptor };

struct Type {
  const char* name;
  double size, depth, volume, solvation;  // angstrom, kcal/mol, angstrom^3, kcal/(mol angstrom^3)
  Hydrogen bond;
  double bond_size, bond_depth;
  double radius;  // of its bonds, angstrom
};

constexpr Type kTypes[] = {
    {"H", 2.00, 0.020, 0, 0.00051, kNone, 0, 0, 0.31},
    {"HD", 2.00, 0.020, 0, 0.00051, kDonor, 0, 0, 0.31},
    {"HS", 2.00, 0.020, 0, 0.00051, kDonor, 0, 0, 0.31},
    {"C", 4.00, 0.150, 33.5103, -0.00143, kNone, 0, 0, 0.76},
    {"A", 4.00, 0.150, 33.5103, -0.00052, kNone, 0, 0, 0.76},
    {"N", 3.50, 0.160, 22.4493, -0.00162, kNone, 0, 0, 0.71},
    {"NA", 3.50, 0.160, 22.4493, -0.00162, kAcceptor, 1.9, 5, 0.71},
    {"NS", 3.50, 0.160, 22.4493, -0.00162, kAcceptor, 1.9, 5, 0.71},
    {"OA", 3.20, 0.200, 17.1573, -0.00251, kAcceptor, 1.9, 5, 0.66},
    {"OS", 3.20, 0.200, 17.1573, -0.00251, kAcceptor, 1.9, 5, 0.66},
    {"F", 3.09, 0.080, 15.4480, -0.00110, kNone, 0, 0, 0.57},
    {"P", 4.20, 0.200, 38.7924, -0.00110, kNone, 0, 0, 1.07},
    {"S", 4.00, 0.200, 33.5103, -0.00214, kNone, 0, 0, 1.05},
    {"SA", 4.00, 0.200, 33.5103, -0.00214, kAcceptor, 2.5, 1, 1.05},
    {"Cl", 4.09, 0.276, 35.8235, -0.00110, kNone, 0, 0, 1.02},
    {"Br", 4.33, 0.389, 42.5661, -0.00110, kNone, 0, 0, 1.20},
    {"I", 4.72, 0.550, 55.0585, -0.00110, kNone, 0, 0, 1.39},
};

const Type& type_of(const std::string& name) {
  for (const Type& type : kTypes)
    if (name == type.name) return type;
  throw std::runtime_error("there are no parameters for atoms of type " + name);
}

/// Value and derivatives of the dielectric function of Mehler and Solmajer (Protein Eng. 4, 903,
/// 1991).
std::array<double, 3> dielectric(double r) {
  constexpr double a = -8.5525, b = 78.4 - a, lambda = 0.003627, k = 7.7839;
  const double e = k * std::exp(-lambda * b * r), below = 1 + e;
  const double d1 = lambda * b * b * e / (below * below);
  return {a + b / below, d1, d1 * lambda * b * (e - 1) / below};
}

/// How many bonds lie between two atoms, up to 4, as row after row.
std::vector<int> bonds_between(const Ligand& ligand) {
  const std::size_t n = ligand.atoms.size();
  std::vector<int> between(n * n, 4);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const double reach =
          1.15 * (type_of(ligand.atoms[i].type).radius + type_of(ligand.atoms[j].type).radius);
      const bool hydrogens = ligand.atoms[i].type[0] == 'H' && ligand.atoms[j].type[0] == 'H';
      if (i == j)
        between[i * n + j] = 0;
      else if (!hydrogens && length(minus(ligand.atoms[i].place, ligand.atoms[j].place)) < reach)
        between[i * n + j] = 1;
    }
  for (std::size_t via = 0; via < n; ++via)  // Floyd and Warshall
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        between[i * n + j] =
            std::min(between[i * n + j], between[i * n + via] + between[via * n + j]);
  return between;
}

/// Whether the distance of two atoms changes with a torsion: one is beyond it, the other is neither
/// beyond it nor on its axis.
bool changes(const Torsion& torsion, std::size_t i, std::size_t j) {
  const auto moved = [&](std::size_t atom) {
    return std::find(torsion.moved.begin(), torsion.moved.end(), atom) != torsion.moved.end();
  };
  const auto fixed = [&](std::size_t atom) {
    return !moved(atom) && atom != torsion.from && atom != torsion.to;
  };
  return (moved(i) && fixed(j)) || (moved(j) && fixed(i));
}

}  // namespace

Pair::Pair(const Atom& a, const Atom& b, std::size_t first, std::size_t second)
    : i(first), j(second) {
  const Type &s = type_of(a.type), &t = type_of(b.type);
  const bool bond =
      (s.bond == kDonor && t.bond == kAcceptor) || (s.bond == kAcceptor && t.bond == kDonor);
  // A well of this depth at this distance: 12-6, or 12-10 for a hydrogen bond.
  best_ = bond ? std::max(s.bond_size, t.bond_size) : (s.size + t.size) / 2;
  const double depth = kJoule * (bond ? kHydrogenBond * std::max(s.bond_depth, t.bond_depth)
                                      : kVanDerWaals * std::sqrt(s.depth * t.depth));
  power_ = bond ? 10 : 6;
  repulsion_ = depth * power_ / (12 - power_);
  attraction_ = depth * 12 / (12 - power_);
  charge_ = kJoule * kElectrostatic * kCoulomb * a.charge * b.charge;
  desolvation_ = kJoule * kDesolvation *
                 ((s.solvation + kChargeSolvation * std::abs(a.charge)) * t.volume +
                  (t.solvation + kChargeSolvation * std::abs(b.charge)) * s.volume);
}

std::array<double, 3> Pair::energy(double r, double soft) const {
  r = std::max(r, 0.1);
  const double near = r < best_ - kSmooth ? r + kSmooth : r > best_ + kSmooth ? r - kSmooth : best_;
  const double ratio = best_ / near, p = power_;
  const double second = ratio * ratio, sixth = second * second * second;
  const double up = repulsion_ * sixth * sixth,
               down = attraction_ * (power_ == 6 ? sixth : sixth * second * second);
  double e = up - down, d1 = 0, d2 = 0;
  if (near != best_) {
    d1 = (-12 * up + p * down) / near;
    d2 = (156 * up - p * (p + 1) * down) / (near * near);
  }
  const auto eps = dielectric(r);
  const double c = charge_ / (r * eps[0]), slope = -1 / r - eps[1] / eps[0];
  e += c;
  d1 += c * slope;
  d2 += c * (slope * slope + 1 / (r * r) - eps[2] / eps[0] + eps[1] * eps[1] / (eps[0] * eps[0]));
  const double g = desolvation_ * std::exp(-r * r / (2 * kSigma * kSigma)),
               k = 1 / (kSigma * kSigma);
  e += g;
  d1 -= g * r * k;
  d2 += g * k * (r * r * k - 1);
  if (e > soft)
    return {soft * (1 + std::log(e / soft)), soft * d1 / e, soft * (d2 / e - d1 * d1 / (e * e))};
  return {e, d1, d2};
}

std::vector<Pair> pairs_of(const Ligand& ligand) {
  std::vector<Pair> pairs;
  if (ligand.torsions.empty()) return pairs;
  const std::vector<int> between = bonds_between(ligand);
  for (std::size_t j = 0; j < ligand.atoms.size(); ++j)
    for (std::size_t i = 0; i < j; ++i)
      if (between[i * ligand.atoms.size() + j] > 3 &&
          std::any_of(ligand.torsions.begin(), ligand.torsions.end(),
                      [&](const Torsion& torsion) { return changes(torsion, i, j); }))
        pairs.emplace_back(ligand.atoms[i], ligand.atoms[j], i, j);
  return pairs;
}

std::vector<std::size_t> softest_torsions(const Ligand& ligand, std::size_t count, double soft) {
  const std::size_t n = ligand.torsions.size();
  if (count > n)
    throw std::runtime_error("ligand: " + std::to_string(count) + " torsions are asked for, and " +
                             std::to_string(n) + " of its bonds turn");
  if (count == 0) return {};
  const std::vector<Pair> pairs = pairs_of(ligand);
  constexpr int kParts = 36;
  std::vector<double> change(n);
  for (std::size_t t = 0; t < n; ++t) {
    double low = 1e300, high = -1e300;
    for (int part = 0; part < kParts; ++part) {
      std::vector<double> angles(n);
      angles[t] = part * 6.28318530717958648 / kParts;
      std::vector<Vector> places(ligand.atoms.size());
      ligand.bend(angles.data(), places.data());
      double sum = 0;
      for (const Pair& pair : pairs)
        sum += pair.energy(length(minus(places[pair.i], places[pair.j])), soft)[0];
      low = std::min(low, sum);
      high = std::max(high, sum);
    }
    change[t] = high - low;
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return change[a] < change[b]; });
  order.resize(count);
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace hapgrid::docking
