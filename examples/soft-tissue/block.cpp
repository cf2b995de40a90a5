#include "examples/soft-tissue/block.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

namespace soft_tissue {

using Matrix3 = Eigen::Matrix3d;

namespace {

/// A factorisation serves again as long as each step leaves less than this part of the force that
/// is out of balance.
constexpr double kKeep = 0.3;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// The points of an integration rule in barycentric coordinates. Each point stands for a third of
/// the area; the rule is exact for quadratic functions.
constexpr double kRule[3][3] = {
    {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}};

Vec3 displacement(const Vector& u, int node) {
  return node < 0 ? Vec3::Zero() : Vec3(u.segment<3>(3 * node));
}

/// Adds the 3 x 3 block of two nodes that count. The rows of each column follow each other in the
/// pattern.
void add_block(int a, int b, const Matrix3& block, Matrix& k) {
  const int* rows = k.innerIndexPtr();
  for (int c = 0; c < 3; ++c) {
    const int first = a == b ? c : 0;
    const int* column = k.outerIndexPtr() + 3 * b + c;
    const int* found = std::lower_bound(rows + column[0], rows + column[1], 3 * a + first);
    double* value = k.valuePtr() + (found - rows);
    for (int r = first; r < 3; ++r) *value++ += block(r, c);
  }
}

}  // namespace

/// The pull is 27/4 adhesion t (1 - t)^2 with t = gap / range: 0 at the range, strongest at a third
/// of it, and 0 again at the touch. From there the pressure grows with the depth, at first as
/// steeply as the pull has ended, and beyond the depth `contact_smoothing` with the full stiffness.
Block::Contact Block::contact(double gap) const {
  const double range = options_.adhesion_range;
  const double pull = 27.0 / 4 * options_.adhesion;
  if (gap > 0) {
    const double t = gap / range;
    const double v = 1 - t;
    return {-pull * range * v * v * v * (1.0 / 3 - v / 4), -pull * t * v * v,
            pull / range * v * (1 - 3 * t)};
  }
  const double depth = -gap;
  const double smoothing = options_.contact_smoothing;
  const double soft = pull / range;
  const double stiff = options_.contact_stiffness - soft;
  const double touch = -pull * range / 12;
  if (depth < smoothing) {
    const double grown = depth * depth / (2 * smoothing);
    return {touch + soft * depth * depth / 2 + stiff * grown * depth / 3,
            soft * depth + stiff * grown, soft + stiff * depth / smoothing};
  }
  return {touch + soft * depth * depth / 2 +
              stiff * (depth * (depth - smoothing) / 2 + smoothing * smoothing / 6),
          soft * depth + stiff * (depth - smoothing / 2), soft + stiff};
}

/// Calls f for each point of the surface that the ball touches or attracts. Its arguments are the
/// triangle, the weights of the triangle's nodes, the point's area, the direction from the ball's
/// centre, the distance from there, and the contact.
template <class F>
void Block::for_contacts(const Vector& u, const Vec3& centre, F&& f) const {
  const double range = options_.adhesion > 0 ? options_.adhesion_range : 0;
  const double reach = options_.probe_radius + range;
  for (const Triangle& t : triangles_) {
    Vec3 x[3];
    for (int a = 0; a < 3; ++a) x[a] = t.rest[a] + displacement(u, t.node[a]) - centre;
    for (const auto& weights : kRule) {
      const Vec3 from = weights[0] * x[0] + weights[1] * x[1] + weights[2] * x[2];
      const double squared = from.squaredNorm();
      if (!(squared < reach * reach)) continue;
      // A point in the ball's very centre has no direction and is not pushed.
      const double distance = std::max(std::sqrt(squared), 1e-9);
      f(t, weights, t.area / 3, Vec3(from / distance), distance,
        contact(distance - options_.probe_radius));
    }
  }
}

bool Block::is_clear(const Vec3& centre) const {
  bool clear = true;
  for_contacts(Vector::Zero(static_cast<Eigen::Index>(unknowns())), centre,
               [&](auto&&...) { clear = false; });
  return clear;
}

double Block::energy(const Vector& u, const Vec3& centre, Vector& gradient) const {
  gradient.setZero(u.size());
  double total = 0;
  for (const Tetrahedron& t : tetrahedra_) {
    Matrix3 f = Matrix3::Identity();
    for (int a = 0; a < 4; ++a)
      if (t.node[a] >= 0) f.noalias() += u.segment<3>(3 * t.node[a]) * t.slope[a].transpose();
    if (!(f.determinant() > 0)) return kInfinity;
    const Matrix3 strain = (f.transpose() * f - Matrix3::Identity()) / 2;
    const double trace = strain.trace();
    total += t.volume * (lambda_ / 2 * trace * trace + mu_ * strain.squaredNorm());
    const Matrix3 stress =
        t.volume * f * (lambda_ * trace * Matrix3::Identity() + 2 * mu_ * strain);
    for (int a = 0; a < 4; ++a)
      if (t.node[a] >= 0) gradient.segment<3>(3 * t.node[a]).noalias() += stress * t.slope[a];
  }
  for_contacts(u, centre,
               [&](const Triangle& t, const double(&weights)[3], double area, const Vec3& direction,
                   double, const Contact& c) {
                 total += area * c.energy;
                 for (int a = 0; a < 3; ++a)
                   if (t.node[a] >= 0)
                     gradient.segment<3>(3 * t.node[a]) -=
                         area * weights[a] * c.pressure * direction;
               });
  return total;
}

/// With the second Piola-Kirchhoff stress S and the gradients a, b of two nodes' shape functions,
/// the 3 x 3 block of an element is V [(a.S b) I + lambda (Fa)(Fb)^T + mu ((a.b) F F^T +
/// (Fb)(Fa)^T)].
void Block::tangent(const Vector& u, const Vec3& centre, Matrix& k) const {
  if (k.nonZeros() != pattern_.nonZeros()) k = pattern_;
  k.coeffs().setZero();
  for (const Tetrahedron& t : tetrahedra_) {
    Matrix3 f = Matrix3::Identity();
    for (int a = 0; a < 4; ++a)
      if (t.node[a] >= 0) f.noalias() += u.segment<3>(3 * t.node[a]) * t.slope[a].transpose();
    const Matrix3 strain = (f.transpose() * f - Matrix3::Identity()) / 2;
    const Matrix3 stress = lambda_ * strain.trace() * Matrix3::Identity() + 2 * mu_ * strain;
    const Matrix3 left = mu_ * f * f.transpose();
    Vec3 turned[4];
    for (int a = 0; a < 4; ++a) turned[a] = f * t.slope[a];
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        if (!counts(t.node[a], t.node[b])) continue;
        Matrix3 block = t.slope[a].dot(t.slope[b]) * left;
        block.noalias() += lambda_ * turned[a] * turned[b].transpose();
        block.noalias() += mu_ * turned[b] * turned[a].transpose();
        block.diagonal().array() += t.slope[a].dot(stress * t.slope[b]);
        add_block(t.node[a], t.node[b], t.volume * block, k);
      }
  }
  for_contacts(u, centre,
               [&](const Triangle& t, const double(&weights)[3], double area, const Vec3& direction,
                   double distance, const Contact& c) {
                 const double around = c.pressure / distance;
                 Matrix3 block = (c.slope + around) * direction * direction.transpose();
                 block.diagonal().array() -= around;
                 for (int a = 0; a < 3; ++a)
                   for (int b = 0; b < 3; ++b)
                     if (counts(t.node[a], t.node[b]))
                       add_block(t.node[a], t.node[b], area * weights[a] * weights[b] * block, k);
               });
}

Vec3 Block::force(const Vector& u, const Vec3& centre) const {
  Vec3 force = Vec3::Zero();
  for_contacts(u, centre,
               [&](const Triangle&, const double(&)[3], double area, const Vec3& direction, double,
                   const Contact& c) { force -= area * c.pressure * direction; });
  return force;
}

/// Factorises k + shift I; false when it is not positive definite.
bool Block::factorise(const Matrix& k, double shift) {
  solver_.setShift(shift);
  solver_.factorize(k);
  return solver_.info() == Eigen::Success && solver_.vectorD().minCoeff() > 0;
}

void Block::relax(Vector& u, const Vec3& centre) { relax(u, centre, false); }

/// A factorisation is kept only within one call, since the result must not depend on other calls.
void Block::follow(Vector& u, const Vec3& from, const Vec3& to, double substep) {
  const Vec3 d = to - from;
  const double steps = std::ceil(d.norm() / substep);
  for (double k = 0; k < steps; ++k) {
    const Vec3 here = from + k / steps * d;
    const Vec3 next = k + 1 < steps ? Vec3(from + (k + 1) / steps * d) : to;
    relax(u, next, predict(u, here, next - here));
  }
}

/// Moves u, in equilibrium at `centre`, as the equilibrium itself moves to first order when the
/// ball moves by d. Newton's method alone would start with the ball deep in the surface and take
/// detours. Returns whether there is a factorisation that relax() can keep.
bool Block::predict(Vector& u, const Vec3& centre, const Vec3& d) {
  Vector push = Vector::Zero(u.size());
  bool touched = false;
  for_contacts(u, centre,
               [&](const Triangle& t, const double(&weights)[3], double area, const Vec3& direction,
                   double distance, const Contact& c) {
                 touched = true;
                 const double along = direction.dot(d);
                 const Vec3 force =
                     c.slope * along * direction - c.pressure / distance * (d - along * direction);
                 for (int a = 0; a < 3; ++a)
                   if (t.node[a] >= 0) push.segment<3>(3 * t.node[a]) += area * weights[a] * force;
               });
  if (!touched) return false;
  Matrix k;
  tangent(u, centre, k);
  if (!factorise(k, 0)) return false;
  const Vector step = solver_.solve(push);
  // Near the loss of stability the first order promises too large a change.
  if (step.lpNorm<Eigen::Infinity>() > 2 * d.norm()) return false;
  Vector gradient;
  const Vector moved = u + step;
  if (energy(moved, centre + d, gradient) == kInfinity) return false;
  u = moved;
  return true;
}

void Block::relax(Vector& u, const Vec3& centre, bool keep) {
  const auto [nx, ny, nz] = options_.elements;
  // No step moves a node by more than half an element's size.
  const double longest =
      std::min({options_.size[0] / nx, options_.size[1] / ny, options_.size[2] / nz}) / 2;
  Vector gradient, trial_gradient, step, trial;
  Matrix k;
  double energy_here = energy(u, centre, gradient);
  double out_of_balance = gradient.lpNorm<Eigen::Infinity>();
  char why[160];
  if (energy_here == kInfinity)
    throw std::runtime_error("an element of the state to start from is inverted");
  for (int iteration = 0; out_of_balance > options_.residual; ++iteration) {
    if (iteration == options_.max_iterations) {
      std::snprintf(why, sizeof why, "no equilibrium after %d iterations: %.3g N out of balance",
                    iteration, out_of_balance);
      throw std::runtime_error(why);
    }
    if (!keep) {
      tangent(u, centre, k);
      // Where the state is not stable, a shift of the matrix makes the step lead downhill.
      double shift = 0;
      while (!factorise(k, shift)) shift = shift > 0 ? 4 * shift : 0.01 * typical_stiffness_;
    }
    step = solver_.solve(-gradient);
    const double size = step.lpNorm<Eigen::Infinity>();
    if (size > longest) step *= longest / size;
    const double slope = gradient.dot(step);
    // The rounding of an energy: relative to its size, and to that of one element.
    const double rounding = 1e-13 * (std::abs(energy_here) + options_.young_modulus);
    double part = 1;
    double trial_energy = kInfinity;
    for (;; part /= 2) {
      if (part < 1e-6) {
        std::snprintf(why, sizeof why, "no equilibrium: %.3g N out of balance%s", out_of_balance,
                      trial_energy == kInfinity ? ", and any step inverts an element" : "");
        throw std::runtime_error(why);
      }
      trial = u + part * step;
      trial_energy = energy(trial, centre, trial_gradient);
      if (trial_energy <= energy_here + 1e-4 * part * slope + rounding) break;
    }
    u.swap(trial);
    gradient.swap(trial_gradient);
    energy_here = trial_energy;
    const double reached = gradient.lpNorm<Eigen::Infinity>();
    // A step with a kept factorisation costs a twentieth of a step with a new one.
    keep = part == 1 && size <= longest && reached < kKeep * out_of_balance;
    out_of_balance = reached;
  }
}

}  // namespace soft_tissue
