#include "tools/apps/molecule/morph.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/apps/molecule/elementary.hpp"

namespace hapgrid::molecule {

namespace {

std::size_t in_fours(std::size_t n) { return (n + 3) / 4 * 4; }

/// Second derivatives times h²/6 of the natural cubic spline through equidistant values, in place:
/// the tridiagonal system z_{i-1} + 4 z_i + z_{i+1} = v_{i-1} - 2 v_i + v_{i+1}, z zero at the
/// ends.
std::vector<double> spline_bends(const std::vector<double>& v) {
  const std::size_t n = v.size();
  std::vector<double> z(n), pivot(n);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double factor = i > 1 ? 1 / pivot[i - 1] : 0;
    pivot[i] = 4 - factor;
    z[i] = v[i - 1] - 2 * v[i] + v[i + 1] - factor * z[i - 1];
  }
  for (std::size_t i = n - 1; i-- > 1;) z[i] = (z[i] - z[i + 1]) / pivot[i];
  return z;
}

/// The same where the values go on after the last as after the first, by the same difference. The
/// ends of a natural spline through three turns are felt no more in the middle one: by 0.27 a
/// value.
std::vector<double> closed_bends(const std::vector<double>& v) {
  const std::size_t turn = v.size() - 1;
  const double rise = v[turn] - v[0];
  std::vector<double> turns;
  for (std::size_t i = 0; i <= 3 * turn; ++i)
    turns.push_back(v[i % turn] + rise * static_cast<double>(i / turn));
  const std::vector<double> z = spline_bends(turns);
  return {z.begin() + static_cast<std::ptrdiff_t>(turn),
          z.begin() + static_cast<std::ptrdiff_t>(2 * turn + 1)};
}

/// Lengths, deflections and torsions one behind the other, each in `stride` places.
std::vector<double> flat(const Internal& internal, std::size_t stride) {
  std::vector<double> q(3 * stride);
  std::copy(internal.length.begin(), internal.length.end(), q.begin());
  std::copy(internal.deflection.begin(), internal.deflection.end(), q.begin() + stride);
  std::copy(internal.torsion.begin(), internal.torsion.end(), q.begin() + 2 * stride);
  return q;
}

/// The largest root of λ⁴ + c2 λ² + c1 λ + c0 below `bound`, by Newton's iteration.
double largest_root(double c2, double c1, double c0, double bound) {
  double lambda = bound;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double l2 = lambda * lambda;
    const double slope = 4 * l2 * lambda + 2 * c2 * lambda + c1;
    const double value = (l2 + c2) * l2 + c1 * lambda + c0;
    if (!(slope > 0) || !(value > 0)) break;
    const double step = value / slope;
    lambda -= step;
    if (step < 1e-12 * lambda) break;
  }
  return lambda;
}

double det3(double a, double b, double c, double d, double e, double f, double g, double h,
            double i) {
  return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
}

using Quaternion = std::array<double, 4>;

/// The rotation R, not normalised, that maximises Σ m c·(R y), from m[3 a + b] = Σ m y_a c_b. It is
/// the eigenvector of Horn's symmetric 4x4 matrix K for its largest eigenvalue, which is at most
/// `bound` = Σ m (|c|² + |y|²) / 2. Source: Theobald, Acta Cryst. A61 (2005) 478.
Quaternion best_rotation(const double* m, double bound) {
  const double xx = m[0], xy = m[1], xz = m[2], yx = m[3], yy = m[4], yz = m[5], zx = m[6],
               zy = m[7], zz = m[8];
  // Horn's matrix, less the eigenvalue on the diagonal further down.
  const double k00 = xx + yy + zz, k11 = xx - yy - zz, k22 = yy - xx - zz, k33 = zz - xx - yy;
  const double k01 = yz - zy, k02 = zx - xz, k03 = xy - yx, k12 = xy + yx, k13 = zx + xz,
               k23 = yz + zy;
  // Characteristic polynomial λ⁴ + c2 λ² + c1 λ + c0; the trace is 0.
  const double c2 = -2 * (xx * xx + xy * xy + xz * xz + yx * yx + yy * yy + yz * yz + zx * zx +
                          zy * zy + zz * zz);
  const double c1 =
      -8 * (xx * (yy * zz - yz * zy) - xy * (yx * zz - yz * zx) + xz * (yx * zy - yy * zx));
  const double c0 = k00 * det3(k11, k12, k13, k12, k22, k23, k13, k23, k33) -
                    k01 * det3(k01, k12, k13, k02, k22, k23, k03, k23, k33) +
                    k02 * det3(k01, k11, k13, k02, k12, k23, k03, k13, k33) -
                    k03 * det3(k01, k11, k12, k02, k12, k22, k03, k13, k23);
  const double lambda = largest_root(c2, c1, c0, bound);
  // The eigenvector is any column of the adjugate of K - λ; the one with the largest diagonal entry
  // has the most digits.
  const double a00 = k00 - lambda, a11 = k11 - lambda, a22 = k22 - lambda, a33 = k33 - lambda;
  const double d0 = det3(a11, k12, k13, k12, a22, k23, k13, k23, a33);
  const double d1 = det3(a00, k02, k03, k02, a22, k23, k03, k23, a33);
  const double d2 = det3(a00, k01, k03, k01, a11, k13, k03, k13, a33);
  const double d3 = det3(a00, k01, k02, k01, a11, k12, k02, k12, a22);
  const double most = std::max({std::abs(d0), std::abs(d1), std::abs(d2), std::abs(d3)});
  const double o01 = -det3(k01, k12, k13, k02, a22, k23, k03, k23, a33);
  const double o02 = det3(k01, a11, k13, k02, k12, k23, k03, k13, a33);
  const double o03 = -det3(k01, a11, k12, k02, k12, a22, k03, k13, k23);
  const double o12 = -det3(a00, k01, k03, k02, k12, k23, k03, k13, a33);
  const double o13 = det3(a00, k01, k02, k02, k12, a22, k03, k13, k23);
  const double o23 = -det3(a00, k01, k02, k01, a11, k12, k03, k13, k23);
  if (most == std::abs(d0)) return {d0, o01, o02, o03};
  if (most == std::abs(d1)) return {o01, d1, o12, o13};
  if (most == std::abs(d2)) return {o02, o12, d2, o23};
  return {o03, o13, o23, d3};
}

std::array<double, 9> matrix_of(const Quaternion& q) {
  const auto [q0, q1, q2, q3] = q;
  const double norm = q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3;
  const double f = 2 / norm;
  return {1 - f * (q2 * q2 + q3 * q3), f * (q1 * q2 - q0 * q3),     f * (q1 * q3 + q0 * q2),
          f * (q1 * q2 + q0 * q3),     1 - f * (q1 * q1 + q3 * q3), f * (q2 * q3 - q0 * q1),
          f * (q1 * q3 - q0 * q2),     f * (q2 * q3 + q0 * q1),     1 - f * (q1 * q1 + q2 * q2)};
}

/// A = R M = Σ m a cᵀ, row by row. At the best rotation it is symmetric.
std::array<double, 9> overlap_of(const std::array<double, 9>& r, const double* m) {
  std::array<double, 9> a;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      a[3 * i + j] = r[3 * i] * m[j] + r[3 * i + 1] * m[3 + j] + r[3 * i + 2] * m[6 + j];
  return a;
}

/// The inverse of tr(A) 1 - A: turning by ω changes the torque Σ m c × a by (tr(A) 1 - A) ω.
std::array<double, 9> inverse_of(const std::array<double, 9>& a) {
  const double b00 = a[4] + a[8], b11 = a[0] + a[8], b22 = a[0] + a[4];
  const double b01 = -(a[1] + a[3]) / 2, b02 = -(a[2] + a[6]) / 2, b12 = -(a[5] + a[7]) / 2;
  const double i00 = b11 * b22 - b12 * b12, i01 = b02 * b12 - b01 * b22,
               i02 = b01 * b12 - b02 * b11;
  const double f = 1 / (b00 * i00 + b01 * i01 + b02 * i02);
  const double i11 = b00 * b22 - b02 * b02, i12 = b01 * b02 - b00 * b12,
               i22 = b00 * b11 - b01 * b01;
  return {f * i00, f * i01, f * i02, f * i01, f * i11, f * i12, f * i02, f * i12, f * i22};
}

/// One Newton step on the rotation itself, which removes what the quartic's rounding has left.
Quaternion refined(const Quaternion& q, const double* m) {
  const auto [q0, q1, q2, q3] = q;
  const std::array<double, 9> a = overlap_of(matrix_of(q), m), inverse = inverse_of(a);
  const double torque[3] = {a[7] - a[5], a[2] - a[6], a[3] - a[1]};  // Σ m c × a
  double w[3];
  for (int i = 0; i < 3; ++i)
    w[i] = -(inverse[3 * i] * torque[0] + inverse[3 * i + 1] * torque[1] +
             inverse[3 * i + 2] * torque[2]) /
           2;
  return {q0 - w[0] * q1 - w[1] * q2 - w[2] * q3, q1 + w[0] * q0 + w[1] * q3 - w[2] * q2,
          q2 + w[1] * q0 + w[2] * q1 - w[0] * q3, q3 + w[2] * q0 + w[0] * q2 - w[1] * q1};
}

/// The atoms as they come, for a molecule that keeps its shape: it may lie on a line.
Tree listed(const Molecule& molecule) {
  Tree tree;
  for (std::size_t i = 0; i < molecule.atoms.size(); ++i) {
    tree.order.push_back(static_cast<int>(i));
    tree.parent.push_back(static_cast<int>(i) - 1);
    tree.first_sibling.push_back(static_cast<int>(i));
    tree.leaf.push_back(i + 1 == molecule.atoms.size());
  }
  return tree;
}

}  // namespace

Morph::Morph(const Molecule& molecule)
    : in_space_(molecule.bonds_change && !molecule.paths.empty()),
      tree_(molecule.paths.empty() || in_space_ ? listed(molecule) : spanning_tree(molecule)),
      first_(in_space_ ? 0 : 1),
      stride_(in_fours(tree_.size())),
      width_(in_fours(molecule.paths.size())) {
  if (molecule.paths.size() > kMaxPaths)
    throw std::runtime_error(std::to_string(molecule.paths.size()) +
                             " transition states, at most " + std::to_string(kMaxPaths) +
                             " are possible");
  weigh(molecule);
  if (molecule.paths.empty()) return;
  if (in_space_) {
    find_splines_in_space(molecule);
  } else {
    find_splines(molecule);
  }
  const auto name = [](std::size_t k) { return "transition_states[" + std::to_string(k) + "]"; };
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    measure(molecule, k);
    paths_[k].closes = paths_[k].closes && meets(k);
    if (paths_[k].length < 1e-3)
      throw std::runtime_error(name(k) +
                               ": the transition state has the shape of the conformation");
  }
}

/// Finds q of the conformation, and the splines of the paths.
void Morph::find_splines(const Molecule& molecule) {
  const Eigen::Matrix3d root = root_frame(tree_, molecule.conformation);
  std::copy_n(root.data(), 9, root_frame_.begin());  // column by column: axis after axis
  const Internal conformation =
      internal_coordinates(tree_, molecule.conformation, nullptr, "conformation");
  q0_ = flat(conformation, stride_);
  for (std::size_t k = 0; k < molecule.paths.size(); ++k)
    paths_.push_back(
        spline(molecule.paths[k], conformation, "transition_states[" + std::to_string(k) + "]"));
}

/// Finds the weights, their centre, and the conformation as seen from there.
void Morph::weigh(const Molecule& molecule) {
  const std::vector<int>& fixed = molecule.fixed;
  centre_.setZero();
  for (const int atom : tree_.order) {
    const bool counts = fixed.empty() || std::find(fixed.begin(), fixed.end(), atom) != fixed.end();
    weight_.push_back(counts ? molecule.atoms[atom]->mass : 0);
    total_weight_ += weight_.back();
    centre_ += weight_.back() * molecule.conformation[atom];
  }
  centre_ /= total_weight_;
  for (std::size_t i = 0; i < tree_.size(); ++i) {
    const Eigen::Vector3d c = molecule.conformation[tree_.order[i]] - centre_;
    x0_.push_back(c.x());
    y0_.push_back(c.y());
    z0_.push_back(c.z());
    weight_x_.push_back(weight_[i] * c.x());
    weight_y_.push_back(weight_[i] * c.y());
    weight_z_.push_back(weight_[i] * c.z());
    square_ += weight_[i] * c.squaredNorm();
    gyration_ += c.squaredNorm();
  }
  gyration_ = std::sqrt(gyration_ / static_cast<double>(tree_.size()));
}

/// The spline through a path's nodes; its length is not known yet. Errors begin with `where`.
Morph::Spline Morph::spline(const Path& path, const Internal& conformation,
                            const std::string& where) const {
  const std::size_t segments = path.nodes.size() - 1;
  std::vector<std::vector<double>> nodes(segments + 1, q0_);
  Internal last = conformation;
  const auto add = [&](std::size_t m) {  // turns go on from the node before
    last =
        internal_coordinates(tree_, path.nodes[m], &last, where + " node " + std::to_string(m + 1));
    nodes[m] = flat(last, stride_);
  };
  for (std::size_t m = path.start + 1; m <= segments; ++m) add(m);
  last = conformation;
  for (std::size_t m = path.start; m-- > 0;) add(m);
  return through(path, nodes, path.closes);
}

/// The natural spline through nodes of q; or, where it closes, one that goes on as it began.
Morph::Spline Morph::through(const Path& path, const std::vector<std::vector<double>>& nodes,
                             bool closes) const {
  const std::size_t segments = nodes.size() - 1, n = q0_.size();
  Spline spline{segments,   std::vector<double>(segments * 4 * n), 0,
                path.low(), static_cast<double>(path.start),       closes};
  std::vector<double> values(segments + 1);
  for (std::size_t c = 0; c < n; ++c) {
    for (std::size_t m = 0; m <= segments; ++m) values[m] = nodes[m][c] - q0_[c];
    // Of one shape twice only torsions may differ, by whole turns.
    if (closes)
      values[segments] =
          values[0] + 2 * kPi * std::round((values[segments] - values[0]) / (2 * kPi));
    const std::vector<double> bend = closes ? closed_bends(values) : spline_bends(values);
    for (std::size_t m = 0; m < segments; ++m) {
      double* a = &spline.coefficients[m * 4 * n + c];
      a[0] = values[m];
      a[n] = values[m + 1] - values[m] - 2 * bend[m] - bend[m + 1];
      a[2 * n] = 3 * bend[m];
      a[3 * n] = bend[m + 1] - bend[m];
    }
  }
  return spline;
}

Morph::Shape Morph::make_shape() const {
  Shape s;
  const std::size_t n = tree_.size();
  for (std::vector<double>* v : {&s.x, &s.y, &s.z}) v->resize(stride_, 1e30);  // touches nothing
  s.t.resize(paths_.size());
  s.q.resize(3 * stride_);
  s.sine.resize(2 * stride_);
  s.cosine.resize(2 * stride_);
  s.frame.resize(9 * n);
  s.local.resize(3 * n);
  s.rate.resize(3 * stride_ * width_);
  s.turning.resize(3 * width_ * n);
  s.moving.resize(3 * width_ * n);
  s.centre_moving.resize(3 * width_);
  s.aligning.resize(3 * width_);
  s.overlap_rate.resize(9 * width_);
  s.pull.resize(3 * n);
  s.twist.resize(3 * n);
  s.weight.resize(3 * stride_);
  return s;
}

HAPGRID_WITH_AVX2
void Morph::interpolate(Shape& s) const {
  const std::size_t n = q0_.size();
  std::copy(q0_.begin(), q0_.end(), s.q.begin());
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    if (s.t[k] == 0) continue;
    const Spline& path = paths_[k];
    const auto [a, u] = path.piece(s.t[k], n);
    double* q = s.q.data();
    for (std::size_t c = 0; c < n; c += 4) {
      const Four value = load<Four>(q + c) + load<Four>(a + c) +
                         u * (load<Four>(a + n + c) +
                              u * (load<Four>(a + 2 * n + c) + u * load<Four>(a + 3 * n + c)));
      store(q + c, value);
    }
  }
}

HAPGRID_WITH_AVX2
void Morph::build(Shape& s) const {
  if (in_space_) {
    for (std::size_t i = 0; i < tree_.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a) s.local[3 * i + a] = s.q[a * stride_ + i];
    return;
  }
  sines_and_cosines(&s.q[stride_], s.sine.data(), s.cosine.data(), 2 * stride_);
  std::copy(root_frame_.begin(), root_frame_.end(), s.frame.begin());
  s.local[0] = s.local[1] = s.local[2] = 0;
  for (std::size_t i = 1; i < tree_.size(); ++i) {
    const auto parent = static_cast<std::size_t>(tree_.parent[i]);
    const double* from = &s.frame[9 * parent];
    double* to = &s.frame[9 * i];
    const double sd = s.sine[i], cd = s.cosine[i];
    const double st = s.sine[stride_ + i], ct = s.cosine[stride_ + i];
    for (int a = 0; a < 3; ++a) {
      const double across = ct * from[3 + a] + st * from[6 + a];
      to[a] = cd * from[a] + sd * across;
      to[3 + a] = cd * across - sd * from[a];
      to[6 + a] = ct * from[6 + a] - st * from[3 + a];
      s.local[3 * i + a] = s.local[3 * parent + a] + s.q[i] * to[a];
    }
  }
}

/// Turns and shifts the local shape so that it lies on the conformation.
HAPGRID_WITH_AVX2
void Morph::align(Shape& s) const {
  const std::size_t n = tree_.size();
  double m[9] = {}, centre[3] = {}, square = 0;  // m[3 a + b] = Σ m y_a c_b
  for (std::size_t i = 0; i < n; ++i) {
    const double* y = &s.local[3 * i];
    for (int a = 0; a < 3; ++a) {
      m[3 * a] += y[a] * weight_x_[i];
      m[3 * a + 1] += y[a] * weight_y_[i];
      m[3 * a + 2] += y[a] * weight_z_[i];
      centre[a] += weight_[i] * y[a];
    }
    square += weight_[i] * (y[0] * y[0] + y[1] * y[1] + y[2] * y[2]);
  }
  for (double& c : centre) c /= total_weight_;
  square -= total_weight_ * (centre[0] * centre[0] + centre[1] * centre[1] + centre[2] * centre[2]);

  s.rotation = matrix_of(refined(best_rotation(m, (square + square_) / 2), m));
  s.overlap = overlap_of(s.rotation, m);
  s.inverse = inverse_of(s.overlap);
  const std::array<double, 9>& r = s.rotation;
  for (std::size_t i = 0; i < n; ++i) {
    const double y0 = s.local[3 * i] - centre[0], y1 = s.local[3 * i + 1] - centre[1],
                 y2 = s.local[3 * i + 2] - centre[2];
    s.x[i] = r[0] * y0 + r[1] * y1 + r[2] * y2;
    s.y[i] = r[3] * y0 + r[4] * y1 + r[5] * y2;
    s.z[i] = r[6] * y0 + r[7] * y1 + r[8] * y2;
  }
}

void Morph::shape(const double* t, Shape& s) const {
  bool same = s.derivatives >= 0;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    const double next = inside(k, t[k]);
    same = same && next == s.t[k];
    s.t[k] = next;
  }
  if (same) return;
  s.derivatives = 0;
  if (paths_.empty()) {
    std::copy(x0_.begin(), x0_.end(), s.x.begin());
    std::copy(y0_.begin(), y0_.end(), s.y.begin());
    std::copy(z0_.begin(), z0_.end(), s.z.begin());
    return;
  }
  interpolate(s);
  build(s);
  align(s);
}

}  // namespace hapgrid::molecule
