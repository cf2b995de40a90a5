#include "tools/apps/docking/pose.hpp"

#include <algorithm>
#include <cmath>
#include <hapgrid/plugin.hpp>
#include <map>
#include <stdexcept>
#include <utility>

namespace hapgrid::docking {

namespace {

constexpr double kLongestTurn = 0.1;    // rad of one step
constexpr double kShortestTurn = 1e-9;  // rad: at rest
constexpr int kMostSteps = 1000;
constexpr double kAboveLowest = 5;  // kJ/mol

double softened(double e, double above) {
  return e > above ? above * (1 + std::log(e / above)) : e;
}

/// An energy E above `above` becomes above (1 + ln(E / above)), with its derivatives.
void soften(table::Spline::Value& v, double above) {
  if (v.value <= above) return;
  const double part = above / v.value, less = part / v.value;
  auto& g = v.gradient;
  const double outer[6] = {g[0] * g[0], g[1] * g[1], g[2] * g[2],
                           g[0] * g[1], g[0] * g[2], g[1] * g[2]};
  for (int k = 0; k < 6; ++k) v.hessian[k] = part * v.hessian[k] - less * outer[k];
  for (double& slope : g) slope *= part;
  v.value = softened(v.value, above);
}

/// w with (H + λ) w = -g by Cholesky's method, where H + λ is positive definite; false when it is
/// not. H: n rows, the lower half.
template <class Rows, class Row>
bool solve(const Rows& h, double lambda, const Row& g, std::size_t n, Row& w) {
  Rows l{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = h[i][j] + (i == j ? lambda : 0);
      for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      if (i != j)
        l[i][j] = sum / l[j][j];
      else if (sum > 1e-12 * (h[i][i] + lambda) && sum > 0)
        l[i][i] = std::sqrt(sum);
      else
        return false;
    }
    w[i] = -g[i];
    for (std::size_t k = 0; k < i; ++k) w[i] -= l[i][k] * w[k];
    w[i] /= l[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) w[i] -= l[k][i] * w[k];
    w[i] /= l[i][i];
  }
  return true;
}

double length(const double* w, std::size_t n) {
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) sum += w[k] * w[k];
  return std::sqrt(sum);
}

}  // namespace

Poses::Poses(Ligand ligand, const std::vector<std::string>& names,
             const std::vector<table::Lattice>& maps, double soft)
    : ligand_(std::move(ligand)), pairs_(pairs_of(ligand_)), soft_(soft) {
  const auto map_of = [&](const std::string& name) -> const std::vector<double>& {
    for (std::size_t m = 0; m < names.size(); ++m)
      if (names[m] == name) return maps[m].values;
    throw std::runtime_error("maps: there is no map " + name +
                             ", which an atom of the ligand needs");
  };
  if (maps.empty() || maps.size() != names.size())
    throw std::runtime_error("maps: there must be as many as names in types");
  lattice_ = maps[0];
  lattice_.values = {};
  lattice_.atoms = {};
  for (const table::Lattice& map : maps)
    if (map.counts != lattice_.counts || map.origin != lattice_.origin || map.axes != lattice_.axes)
      throw std::runtime_error("maps: they have different points");
  std::map<std::pair<std::string, double>, std::size_t> kinds;
  for (const Atom& atom : ligand_.atoms) {
    const auto [kind, added] = kinds.try_emplace({atom.type, atom.charge}, splines_.size());
    kind_.push_back(kind->second);
    if (!added) continue;
    std::vector<double> values = map_of(atom.type);
    const std::vector<double>&e = map_of("e"), &d = map_of("d");
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = kJoule * (values[i] + atom.charge * e[i] + std::abs(atom.charge) * d[i]);
      if (!std::isfinite(values[i])) throw std::runtime_error("maps: a value is missing");
    }
    base_.push_back(*std::min_element(values.begin(), values.end()) - kAboveLowest);
    for (double& value : values) value = std::log(value - base_.back());
    splines_.emplace_back(lattice_.counts, values);
  }
}

Poses::Poses(Ligand ligand, std::vector<Atom> host, double soft)
    : ligand_(std::move(ligand)),
      pairs_(pairs_of(ligand_)),
      host_(std::move(host)),
      host_pairs_(ligand_.atoms.size()),
      soft_(soft) {
  for (std::size_t i = 0; i < ligand_.atoms.size(); ++i)
    for (std::size_t j = 0; j < host_.size(); ++j)
      host_pairs_[i].emplace_back(ligand_.atoms[i], host_[j], i, j);
}

table::Spline::Value Poses::among_atoms(std::size_t atom, const Vector& place) const {
  table::Spline::Value v;
  auto& h = v.hessian;
  for (const Pair& pair : host_pairs_[atom]) {
    const Vector r = minus(place, host_[pair.j].place);
    const double away = std::max(length(r), 1e-3);
    const auto [energy, first, second] = pair.energy(away);
    v.value += energy;
    const double slope = first / away, bend = (second - slope) / (away * away);
    for (int a = 0; a < 3; ++a) {
      v.gradient[a] += slope * r[a];
      h[a] += slope + bend * r[a] * r[a];
    }
    h[3] += bend * r[0] * r[1];
    h[4] += bend * r[0] * r[2];
    h[5] += bend * r[1] * r[2];
  }
  soften(v, soft_);
  return v;
}

table::Spline::Value Poses::alone(std::size_t atom, const Vector& place, bool with_hessian) const {
  if (!host_.empty()) return among_atoms(atom, place);
  const auto& m = lattice_.inverse;
  const table::Spline::Value v =
      splines_[kind_[atom]].at(lattice_.coordinates(place.data()), with_hessian);
  table::Spline::Value out;
  const double above = std::exp(v.value);
  out.value = base_[kind_[atom]] + above;
  const Vector g = lattice_.gradient(v.gradient);
  for (int c = 0; c < 3; ++c) out.gradient[c] = above * g[c];
  constexpr int kOf[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  for (int c = 0; c < 3 && with_hessian; ++c)
    for (int d = c; d < 3; ++d) {
      double bend = g[c] * g[d];
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) bend += m[a][c] * v.hessian[kOf[a][b]] * m[b][d];
      out.hessian[kOf[c][d]] = above * bend;
    }
  soften(out, soft_);
  return out;
}

void Poses::places(const double* x, const double* s, Vector* places) const {
  ligand_.bend(s + 6, places);
  for (std::size_t i = 0; i < ligand_.atoms.size(); ++i) {
    const Vector place = places[i];
    orientation::apply(s, place.data(), places[i].data());
    for (int a = 0; a < 3; ++a) places[i][a] += x[a];
  }
}

double Poses::energy(const double* x, const double* s, double* gradient) const {
  std::array<Vector, kMostAtoms> at;
  places(x, s, at.data());
  double sum = 0, g[3] = {0, 0, 0};
  for (std::size_t i = 0; i < ligand_.atoms.size(); ++i) {
    const table::Spline::Value v = alone(i, at[i], false);
    sum += v.value;
    for (int c = 0; c < 3; ++c) g[c] += v.gradient[c];
  }
  for (const Pair& pair : pairs_) {
    const Vector r = minus(at[pair.i], at[pair.j]);
    sum += pair.energy(length(r), soft_)[0];
  }
  const double slope = sum > soft_ ? soft_ / sum : 1;
  if (gradient)
    for (int c = 0; c < 3; ++c) gradient[c] = slope * g[c];
  return softened(sum, soft_);
}

void Poses::find_motions(const Vector* arms, std::array<Vector, kMost>* motions,
                         Vector* axes) const {
  const std::size_t n = ligand_.atoms.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector& r = arms[i];
    motions[i] = {{{0, -r[2], r[1]}, {r[2], 0, -r[0]}, {-r[1], r[0], 0}}};
  }
  for (std::size_t t = 0; t < ligand_.torsions.size(); ++t) {
    const Torsion& torsion = ligand_.torsions[t];
    axes[t] = minus(arms[torsion.to], arms[torsion.from]);
    const double size = length(axes[t]);
    for (double& c : axes[t]) c /= size;
    // The centre of all atoms stays where it is, so all of them give way a little.
    Vector mean{};
    for (const std::size_t i : torsion.moved) {
      motions[i][3 + t] = cross(axes[t], minus(arms[i], arms[torsion.from]));
      for (int a = 0; a < 3; ++a) mean[a] += motions[i][3 + t][a] / static_cast<double>(n);
    }
    for (std::size_t i = 0; i < n; ++i) motions[i][3 + t] = minus(motions[i][3 + t], mean);
  }
}

/// What the second derivatives of the places by the turns add, with g the slope of the energy at
/// each atom. With r the place of an atom from the centre and a turn by w, the atom goes to
/// r + w × r + w × (w × r) / 2; and likewise around the axis of a torsion.
void Poses::add_curvature(const Vector* arms, const std::array<Vector, kMost>* motions,
                          const Vector* axes, const Vector* g, Torque& out) const {
  const std::size_t n = ligand_.atoms.size(), turns = ligand_.torsions.size();
  Vector mean{};
  for (std::size_t i = 0; i < n; ++i) {
    const Vector& r = arms[i];
    const double along = dot(g[i], r);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t l = 0; l <= k; ++l)
        out.bend[k][l] += (g[i][k] * r[l] + g[i][l] * r[k]) / 2 - (k == l ? along : 0);
      mean[k] += g[i][k] / static_cast<double>(n);
    }
    for (std::size_t t = 0; t < turns; ++t) {
      const Vector mixed = cross(motions[i][3 + t], g[i]);
      for (std::size_t k = 0; k < 3; ++k) out.bend[3 + t][k] += mixed[k];
    }
  }
  for (std::size_t t = 0; t < turns; ++t)
    for (std::size_t u = 0; u <= t; ++u) {  // u is nearer to the root
      const Torsion &outer = ligand_.torsions[t], &inner = ligand_.torsions[u];
      if (t != u &&
          std::find(inner.moved.begin(), inner.moved.end(), outer.to) == inner.moved.end())
        continue;
      for (const std::size_t i : outer.moved) {
        const Vector once = cross(axes[t], minus(arms[i], arms[outer.from]));
        out.bend[3 + t][3 + u] += dot(minus(g[i], mean), cross(axes[u], once));
      }
    }
}

/// The softened energy has its minima where the energy has them, so it is not needed here.
Poses::Torque Poses::torque(const double* x, const double* s) const {
  Torque out;
  const std::size_t n = ligand_.atoms.size(), turns = ligand_.state_size() - 3;
  std::array<Vector, kMostAtoms> arms, g{};
  std::array<std::array<Vector, kMost>, kMostAtoms> motions;
  std::array<Vector, kMostTorsions> axes;
  const double centre[3] = {0, 0, 0};
  places(centre, s, arms.data());
  find_motions(arms.data(), motions.data(), axes.data());
  for (std::size_t i = 0; i < n; ++i) {
    const table::Spline::Value v =
        alone(i, {x[0] + arms[i][0], x[1] + arms[i][1], x[2] + arms[i][2]}, true);
    const auto& u = v.hessian;
    const Matrix h = {{{u[0], u[3], u[4]}, {u[3], u[1], u[5]}, {u[4], u[5], u[2]}}};
    g[i] = v.gradient;
    out.energy += v.value;
    for (std::size_t k = 0; k < turns; ++k) {
      const Vector& j = motions[i][k];
      const Vector bent = {dot(h[0], j), dot(h[1], j), dot(h[2], j)};
      for (std::size_t l = 0; l <= k; ++l) out.bend[k][l] += dot(bent, motions[i][l]);
    }
  }
  for (const Pair& pair : pairs_) {
    Vector r = minus(arms[pair.i], arms[pair.j]);
    const double away = length(r);
    const auto [energy, slope, bend] = pair.energy(away, soft_);
    out.energy += energy;
    for (int a = 0; a < 3; ++a) {
      r[a] /= away;
      g[pair.i][a] += slope * r[a];
      g[pair.j][a] -= slope * r[a];
    }
    for (std::size_t k = 0; k < turns; ++k) {
      const Vector by_k = minus(motions[pair.i][k], motions[pair.j][k]);
      for (std::size_t l = 0; l <= k; ++l) {
        const Vector by_l = minus(motions[pair.i][l], motions[pair.j][l]);
        out.bend[k][l] +=
            slope / away * dot(by_k, by_l) + (bend - slope / away) * dot(by_k, r) * dot(by_l, r);
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < turns; ++k) out.slope[k] += dot(g[i], motions[i][k]);
  add_curvature(arms.data(), motions.data(), axes.data(), g.data(), out);
  return out;
}

void Poses::relax(const double* x, double* s) const {
  const std::size_t size = ligand_.state_size(), turns = size - 3;
  Torque at = torque(x, s);
  double longest = kLongestTurn;
  for (int step = 0; step < kMostSteps; ++step) {
    double scale = 1e-9, lambda = 0;
    for (std::size_t k = 0; k < turns; ++k)
      for (std::size_t l = 0; l <= k; ++l) scale += std::abs(at.bend[k][l]);
    std::array<double, kMost> w{};
    // The first lambda is small: one that is much larger than the curvature of a flat ridge would
    // make its steps so short that they do not leave it.
    while (!solve(at.bend, lambda, at.slope, turns, w) || length(w.data(), turns) > longest)
      lambda = lambda == 0 ? 1e-9 * scale : 2 * lambda;
    const double way = length(w.data(), turns);
    if (way < kShortestTurn) return;
    std::array<double, 6 + kMostTorsions> next{};
    std::copy_n(s, size, next.data());
    orientation::turn(next.data(), w.data());
    for (std::size_t k = 3; k < turns; ++k) next[3 + k] += w[k];
    const Torque there = torque(x, next.data());
    // Only downhill: a path that climbs would give energy away. What rounding hides ends the
    // search.
    if (there.energy < at.energy) {
      std::copy_n(next.data(), size, s);
      at = there;
      longest = std::min(kLongestTurn, 2 * longest);
    } else {
      if (there.energy - at.energy < 1e-11 * (1 + std::abs(at.energy)) && way < 1e-5) return;
      longest = way / 4;
      if (longest < kShortestTurn) return;
    }
  }
  throw std::runtime_error("the ligand does not come to rest");
}

void Poses::choose(double* s) const {
  for (std::size_t t = 0; t < ligand_.torsions.size(); ++t)
    s[6 + t] = std::remainder(s[6 + t], ligand_.torsions[t].period);
  double best[6], most = -1e300;
  for (const Matrix& turn : ligand_.symmetry) {
    double columns[6];
    for (int c = 0; c < 2; ++c) {
      const double column[3] = {turn[0][c], turn[1][c], turn[2][c]};
      orientation::apply(s, column, columns + 3 * c);
    }
    // The trace of the matrix, whose third column is the cross product.
    const double trace =
        columns[0] + columns[4] + columns[0] * columns[4] - columns[1] * columns[3];
    if (trace > most + 1e-9) {
      most = trace;
      std::copy_n(columns, 6, best);
    }
  }
  std::copy_n(best, 6, s);
  // On a line, all turns around it are the same: the shortest turn that brings the axis there.
  const Vector& u = ligand_.axis;
  double v[3], w[3];
  orientation::apply(s, u.data(), v);
  if (ligand_.symmetry.size() > 1 && u[0] * v[0] + u[1] * v[1] + u[2] * v[2] < 0)
    for (double& c : v) c = -c;
  for (int a = 0; a < 3; ++a)
    w[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
  const double sine = length(w, 3), cosine = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  if (!(sine > 1e-9)) return;  // no line, or none of the turns is the shortest
  for (double& c : w) c *= std::atan2(sine, cosine) / sine;
  const double file[6] = {1, 0, 0, 0, 1, 0};
  std::copy_n(file, 6, s);
  orientation::turn(s, w);
}

}  // namespace hapgrid::docking
