#include "examples/docking/pose.hpp"

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

double softened(double e, double above) {
  return e > above ? above * (1 + std::log(e / above)) : e;
}

/// w with (H + λ) w = -g, where H + λ is positive definite; false when it is not.
bool solve(const std::array<double, 6>& h, double lambda, const std::array<double, 3>& g,
           double* w) {
  const double a = h[0] + lambda;
  if (!(a > 0)) return false;
  const double b = h[3] / a, c = h[4] / a;
  const double d = h[1] + lambda - b * h[3];
  if (!(d > 1e-12 * a)) return false;
  const double e = (h[5] - b * h[4]) / d;
  const double f = h[2] + lambda - c * h[4] - e * e * d;
  if (!(f > 1e-12 * a)) return false;
  const double y0 = -g[0], y1 = -g[1] - b * y0, y2 = -g[2] - c * y0 - e * y1;
  w[2] = y2 / f;
  w[1] = y1 / d - e * w[2];
  w[0] = y0 / a - b * w[1] - c * w[2];
  return true;
}

double length(const double* w) { return std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]); }

}  // namespace

Poses::Poses(Ligand ligand, const std::vector<std::string>& names,
             const std::vector<table::Lattice>& maps, double soft)
    : ligand_(std::move(ligand)), soft_(soft) {
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
  for (const LigandAtom& atom : ligand_.atoms) {
    const auto [kind, added] = kinds.try_emplace({atom.type, atom.charge}, splines_.size());
    kind_.push_back(kind->second);
    if (!added) continue;
    std::vector<double> values = map_of(atom.type);
    const std::vector<double>&e = map_of("e"), &d = map_of("d");
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] =
          softened(kJoule * (values[i] + atom.charge * e[i] + std::abs(atom.charge) * d[i]), soft_);
      if (!std::isfinite(values[i])) throw std::runtime_error("maps: a value is missing");
    }
    splines_.emplace_back(lattice_.counts, values);
  }
}

double Poses::energy(const double* x, const double* s, double* gradient) const {
  double sum = 0, g[3] = {0, 0, 0};
  for (std::size_t i = 0; i < ligand_.atoms.size(); ++i) {
    double place[3];
    orientation::apply(s, ligand_.atoms[i].place.data(), place);
    for (int a = 0; a < 3; ++a) place[a] += x[a];
    const table::Spline::Value v = splines_[kind_[i]].at(lattice_.coordinates(place));
    sum += v.value;
    for (int c = 0; c < 3; ++c)
      for (int a = 0; a < 3; ++a) g[c] += lattice_.inverse[a][c] * v.gradient[a];
  }
  const double slope = sum > soft_ ? soft_ / sum : 1;
  if (gradient)
    for (int c = 0; c < 3; ++c) gradient[c] = slope * g[c];
  return softened(sum, soft_);
}

/// With r the place of an atom from the centre and a turn by w, the atom goes to r + w × r +
/// w × (w × r) / 2, which gives the derivatives below. The softened energy has its minima where the
/// energy has them, so it is not needed here.
Poses::Torque Poses::torque(const double* x, const double* s) const {
  Torque out;
  for (std::size_t i = 0; i < ligand_.atoms.size(); ++i) {
    double r[3], place[3];
    orientation::apply(s, ligand_.atoms[i].place.data(), r);
    for (int a = 0; a < 3; ++a) place[a] = x[a] + r[a];
    const table::Spline::Value v = splines_[kind_[i]].at(lattice_.coordinates(place), true);
    const auto& m = lattice_.inverse;
    const double u[3][3] = {{v.hessian[0], v.hessian[3], v.hessian[4]},
                            {v.hessian[3], v.hessian[1], v.hessian[5]},
                            {v.hessian[4], v.hessian[5], v.hessian[2]}};
    double g[3] = {0, 0, 0}, h[3][3] = {};
    for (int c = 0; c < 3; ++c)
      for (int a = 0; a < 3; ++a) {
        g[c] += m[a][c] * v.gradient[a];
        for (int d = 0; d < 3; ++d)
          for (int b = 0; b < 3; ++b) h[c][d] += m[a][c] * u[a][b] * m[b][d];
      }
    out.energy += v.value;
    out.slope[0] += r[1] * g[2] - r[2] * g[1];
    out.slope[1] += r[2] * g[0] - r[0] * g[2];
    out.slope[2] += r[0] * g[1] - r[1] * g[0];
    // Column k of j is what a turn around axis k does to the atom: e_k × r.
    const double j[3][3] = {{0, r[2], -r[1]}, {-r[2], 0, r[0]}, {r[1], -r[0], 0}};
    const double gr = g[0] * r[0] + g[1] * r[1] + g[2] * r[2];
    static constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int p = 0; p < 6; ++p) {
      const auto [k, l] = kPairs[p];
      double bend = (g[k] * r[l] + g[l] * r[k]) / 2 - (k == l ? gr : 0);
      for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d) bend += j[k][c] * h[c][d] * j[l][d];
      out.bend[p] += bend;
    }
  }
  return out;
}

void Poses::relax(const double* x, double* s) const {
  Torque at = torque(x, s);
  double longest = kLongestTurn;
  for (int step = 0; step < kMostSteps; ++step) {
    const auto& h = at.bend;
    const double size = std::abs(h[0]) + std::abs(h[1]) + std::abs(h[2]) + std::abs(h[3]) +
                        std::abs(h[4]) + std::abs(h[5]) + 1e-9;
    double w[3], lambda = 0;
    while (!solve(h, lambda, at.slope, w) || length(w) > longest)
      lambda = lambda == 0 ? 1e-3 * size : 2 * lambda;
    if (length(w) < kShortestTurn) return;
    double next[6];
    std::copy_n(s, 6, next);
    orientation::turn(next, w);
    const Torque there = torque(x, next);
    // Only downhill: a path that climbs would give energy away. What rounding hides ends the
    // search.
    if (there.energy < at.energy) {
      std::copy_n(next, 6, s);
      at = there;
      longest = std::min(kLongestTurn, 2 * longest);
    } else {
      if (there.energy - at.energy < 1e-11 * (1 + std::abs(at.energy)) && length(w) < 1e-5) return;
      longest = length(w) / 4;
      if (longest < kShortestTurn) return;
    }
  }
  throw std::runtime_error("the ligand does not come to rest");
}

void Poses::choose(double* s) const {
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
  const double sine = length(w), cosine = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  if (!(sine > 1e-9)) return;  // no line, or none of the turns is the shortest
  for (double& c : w) c *= std::atan2(sine, cosine) / sine;
  const double file[6] = {1, 0, 0, 0, 1, 0};
  std::copy_n(file, 6, s);
  orientation::turn(s, w);
}

}  // namespace hapgrid::docking
