// How the shape changes with t: see morph.hpp.
#include <algorithm>
#include <cmath>

#include "tools/apps/molecule/morph.hpp"

namespace hapgrid::molecule {

/// Finds the length of a path.
void Morph::measure(const Molecule& molecule, std::size_t k) {
  const Path& path = molecule.paths[k];
  const std::size_t steps = path.beyond() ? paths_[k].segments : 1;
  Shape from = make_shape(), to = make_shape();
  std::vector<double> t(paths_.size());
  t[k] = paths_[k].low;
  shape(t.data(), from);
  for (std::size_t m = 1; m <= steps; ++m) {
    t[k] = paths_[k].low + static_cast<double>(m) / static_cast<double>(steps);
    shape(t.data(), to);
    double sum = 0;
    for (std::size_t i = 0; i < tree_.size(); ++i) {
      const double d[3] = {to.x[i] - from.x[i], to.y[i] - from.y[i], to.z[i] - from.z[i]};
      sum += d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    }
    paths_[k].length += std::sqrt(sum / static_cast<double>(tree_.size()));
    std::swap(from, to);
  }
}

/// Whether the shape comes to its place again at the end of a path that closes. Where the alignment
/// heeds the whole molecule it can lie there another way round.
bool Morph::meets(std::size_t k) const {
  constexpr double kNear = 1e-4;  // of the path, from its ends
  Shape from = make_shape(), to = make_shape();
  std::vector<double> t(paths_.size());
  t[k] = paths_[k].low + kNear;
  shape(t.data(), from);
  t[k] = paths_[k].low + 1 - kNear;
  shape(t.data(), to);
  double farthest = 0;
  for (std::size_t i = 0; i < tree_.size(); ++i)
    farthest = std::max(farthest,
                        std::hypot(to.x[i] - from.x[i], to.y[i] - from.y[i], to.z[i] - from.z[i]));
  return farthest < 0.1;  // Å
}

/// From velocities v of the atoms: sum[3 a + b] = Σ m v_a c_b, and the velocity of the centre of
/// mass. Each component of a velocity has `stride` numbers; the four from `at` on are taken.
HAPGRID_WITH_AVX2
Morph::Moments Morph::moments(const std::vector<double>& velocities, std::size_t stride,
                              std::size_t at) const {
  Moments m{};
  for (std::size_t i = first_; i < tree_.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      const Four v = load<Four>(&velocities[(3 * i + a) * stride + at]);
      m.sum[3 * a] += v * weight_x_[i];
      m.sum[3 * a + 1] += v * weight_y_[i];
      m.sum[3 * a + 2] += v * weight_z_[i];
      m.centre[a] += v * weight_[i];
    }
  }
  for (Four& c : m.centre) c = c / total_weight_;
  return m;
}

/// When A changes by p the alignment has a torque; this finds the turn that removes it.
void Morph::turn_back(const Shape& s, const Four* p, double* turn, std::size_t stride) {
  const Four torque[3] = {p[7] - p[5], p[2] - p[6], p[3] - p[1]};
  for (std::size_t a = 0; a < 3; ++a)
    store(turn + a * stride, -(s.inverse[3 * a] * torque[0] + s.inverse[3 * a + 1] * torque[1] +
                               s.inverse[3 * a + 2] * torque[2]));
}

HAPGRID_WITH_AVX2
void Morph::differentiate(Shape& s) const {
  if (s.derivatives >= 1 || paths_.empty()) return;
  s.derivatives = 1;
  const std::size_t w = width_;
  const std::size_t coordinates = q0_.size();
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    const Spline& path = paths_[k];
    const double segments = static_cast<double>(path.segments);
    const auto [a, u] = path.piece(s.t[k], coordinates);
    const double f1 = segments, f2 = 2 * u * segments, f3 = 3 * u * u * segments;
    for (std::size_t c = 0; c < coordinates; c += 4) {
      const Four rate = f1 * load<Four>(a + coordinates + c) +
                        f2 * load<Four>(a + 2 * coordinates + c) +
                        f3 * load<Four>(a + 3 * coordinates + c);
      for (std::size_t l = 0; l < 4; ++l) s.rate[(c + l) * w + k] = rate[l];
    }
  }
  differentiate_tree(s);
  // The alignment follows: with W = Σ m v cᵀ (v local), A changes by R W and the torque by
  // Σ m c × (R v), which (tr(A) 1 - A) ω removes.
  const std::array<double, 9>& r = s.rotation;
  for (std::size_t k = 0; k < w; k += 4) {
    const auto [sum, centre] = moments(s.moving, w, k);
    for (std::size_t a = 0; a < 3; ++a) store(&s.centre_moving[a * w + k], centre[a]);
    Four p[9];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        p[3 * i + j] = r[3 * i] * sum[j] + r[3 * i + 1] * sum[3 + j] + r[3 * i + 2] * sum[6 + j];
    for (std::size_t a = 0; a < 9; ++a) store(&s.overlap_rate[a * w + k], p[a]);
    turn_back(s, p, &s.aligning[k], w);
  }
}

/// A frame turns with its parent's frame, about the parent's x with the torsion, and about its own
/// z with the deflection. All paths are computed at once, four in a vector.
HAPGRID_WITH_AVX2
void Morph::differentiate_tree(Shape& s) const {
  const std::size_t w = width_;
  if (in_space_) {
    for (std::size_t i = 0; i < tree_.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a)
        std::copy_n(&s.rate[(a * stride_ + i) * w], w, &s.moving[(3 * i + a) * w]);
    return;
  }
  std::fill_n(s.turning.begin(), 3 * w, 0.0);
  std::fill_n(s.moving.begin(), 3 * w, 0.0);
  for (std::size_t i = 1; i < tree_.size(); ++i) {
    const auto parent = static_cast<std::size_t>(tree_.parent[i]);
    const double* from = &s.frame[9 * parent];
    const double* to = &s.frame[9 * i];
    const double* length_rate = &s.rate[i * w];
    const double* deflection_rate = &s.rate[(stride_ + i) * w];
    const double* torsion_rate = &s.rate[(2 * stride_ + i) * w];
    const double* turning_from = &s.turning[3 * w * parent];
    const double* moving_from = &s.moving[3 * w * parent];
    double* turning = &s.turning[3 * w * i];
    double* moving = &s.moving[3 * w * i];
    const double length = s.q[i];
    for (std::size_t k = 0; k < w; k += 4) {
      const Four torsion = load<Four>(torsion_rate + k),
                 deflection = load<Four>(deflection_rate + k),
                 stretch = load<Four>(length_rate + k);
      const Four w0 = load<Four>(turning_from + k) + torsion * from[0] + deflection * to[6];
      const Four w1 = load<Four>(turning_from + w + k) + torsion * from[1] + deflection * to[7];
      const Four w2 = load<Four>(turning_from + 2 * w + k) + torsion * from[2] + deflection * to[8];
      store(turning + k, w0);
      store(turning + w + k, w1);
      store(turning + 2 * w + k, w2);
      store(moving + k,
            load<Four>(moving_from + k) + stretch * to[0] + length * (w1 * to[2] - w2 * to[1]));
      store(moving + w + k,
            load<Four>(moving_from + w + k) + stretch * to[1] + length * (w2 * to[0] - w0 * to[2]));
      store(moving + 2 * w + k, load<Four>(moving_from + 2 * w + k) + stretch * to[2] +
                                    length * (w0 * to[1] - w1 * to[0]));
    }
  }
}

HAPGRID_WITH_AVX2
void Morph::velocity(const Shape& s, std::size_t i, double* v) const {
  const std::array<double, 9>& r = s.rotation;
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    const double m0 = s.moving[(3 * i) * width_ + k] - s.centre_moving[k];
    const double m1 = s.moving[(3 * i + 1) * width_ + k] - s.centre_moving[width_ + k];
    const double m2 = s.moving[(3 * i + 2) * width_ + k] - s.centre_moving[2 * width_ + k];
    const double w0 = s.aligning[k], w1 = s.aligning[width_ + k], w2 = s.aligning[2 * width_ + k];
    v[3 * k] = r[0] * m0 + r[1] * m1 + r[2] * m2 + w1 * s.z[i] - w2 * s.y[i];
    v[3 * k + 1] = r[3] * m0 + r[4] * m1 + r[5] * m2 + w2 * s.x[i] - w0 * s.z[i];
    v[3 * k + 2] = r[6] * m0 + r[7] * m1 + r[8] * m2 + w0 * s.y[i] - w1 * s.x[i];
  }
}

// The second derivatives of what differentiate() computes are linear in those of the bonds'
// vectors, ∂²(length x). A weighted sum over atoms needs only the weights of the bonds: for each
// bond the sum S of the forces on the atoms behind it, and for each frame the torque Q on what
// turns with it. They are collected from the leaves to the root. The alignment turns by u · torque,
// so it is one more force on each atom, and so is the shift of the centre of mass.
HAPGRID_WITH_AVX2
void Morph::curvature(Shape& s, const Pull* pulls, std::size_t count, double* out) const {
  const std::size_t w = width_, paths = paths_.size();
  if (paths == 0) return;
  const std::array<double, 9>& r = s.rotation;
  // Sums over the atoms that are pulled, in the conformation's frame.
  double force[3] = {}, torque[3] = {}, spread[9] = {};  // spread: Σ f aᵀ
  double moved[kMaxPaths][3] = {};                       // Σ (R v_k) x f
  std::fill(s.pull.begin(), s.pull.end(), 0.0);
  for (const Pull* p = pulls; p != pulls + count; ++p) {
    const double* f = p->force;
    const double at[3] = {s.x[p->place], s.y[p->place], s.z[p->place]};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      force[a] += f[a];
      torque[a] += at[b] * f[c] - at[c] * f[b];
      for (std::size_t j = 0; j < 3; ++j) spread[3 * a + j] += f[a] * at[j];
      s.pull[3 * p->place + a] += r[a] * f[0] + r[3 + a] * f[1] + r[6 + a] * f[2];
    }
    for (std::size_t k = 0; k < paths; ++k) {
      double m[3], v[3];
      for (std::size_t a = 0; a < 3; ++a)
        m[a] = s.moving[(3 * p->place + a) * w + k] - s.centre_moving[a * w + k];
      for (std::size_t a = 0; a < 3; ++a)
        v[a] = r[3 * a] * m[0] + r[3 * a + 1] * m[1] + r[3 * a + 2] * m[2];
      for (std::size_t a = 0; a < 3; ++a)
        moved[k][a] += v[(a + 1) % 3] * f[(a + 2) % 3] - v[(a + 2) % 3] * f[(a + 1) % 3];
    }
  }
  double u[3];
  for (std::size_t a = 0; a < 3; ++a)
    u[a] = s.inverse[3 * a] * torque[0] + s.inverse[3 * a + 1] * torque[1] +
           s.inverse[3 * a + 2] * torque[2];
  spread_pulls(s, force, u);
  std::array<double, kMaxPaths * kMaxPaths> sum{};
  sweep(s, sum.data());

  const double trace = spread[0] + spread[4] + spread[8];
  double turn[kMaxPaths][3];                                      // ω_k
  double row[kMaxPaths][3] = {};                                  // uᵀ P_k
  double turned_row[kMaxPaths][3] = {};                           // uᵀ (P_k + [ω_k] A)
  double at_u[kMaxPaths], own[kMaxPaths], turned_own[kMaxPaths];  // u · ω_k, and the traces
  for (std::size_t k = 0; k < paths; ++k) {
    double* const o = turn[k];
    for (std::size_t a = 0; a < 3; ++a) o[a] = s.aligning[a * w + k];
    at_u[k] = u[0] * o[0] + u[1] * o[1] + u[2] * o[2];
    own[k] = turned_own[k] = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      for (std::size_t j = 0; j < 3; ++j) {
        const double p = s.overlap_rate[(3 * a + j) * w + k];
        const double turned = p + o[b] * s.overlap[3 * c + j] - o[c] * s.overlap[3 * b + j];
        row[k][j] += u[a] * p;
        turned_row[k][j] += u[a] * turned;
        if (j == a) own[k] += p, turned_own[k] += turned;
      }
    }
  }
  for (std::size_t k = 0; k < paths; ++k) {
    for (std::size_t l = k; l < paths; ++l) {
      double c = sum[k * w + l] - at_u[l] * own[k] - at_u[k] * turned_own[l];
      double product = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        c += row[k][a] * turn[l][a] + turned_row[l][a] * turn[k][a] + turn[l][a] * moved[k][a] +
             turn[k][a] * moved[l][a];
        product += turn[k][a] * turn[l][a];
        for (std::size_t j = 0; j < 3; ++j) c += turn[l][a] * spread[3 * a + j] * turn[k][j];
      }
      out[k * paths + l] = out[l * paths + k] = c - trace * product;
    }
  }
}

/// Adds to the atoms' forces what the centre of mass and the alignment (u) make of them.
HAPGRID_WITH_AVX2
void Morph::spread_pulls(Shape& s, const double* force, const double* u) const {
  const std::array<double, 9>& r = s.rotation;
  double shared[3], turned[9];  // Rᵀ force / M, Rᵀ [u]
  for (std::size_t a = 0; a < 3; ++a) {
    shared[a] = (r[a] * force[0] + r[3 + a] * force[1] + r[6 + a] * force[2]) / total_weight_;
    turned[3 * a] = r[3 + a] * u[2] - r[6 + a] * u[1];
    turned[3 * a + 1] = r[6 + a] * u[0] - r[a] * u[2];
    turned[3 * a + 2] = r[a] * u[1] - r[3 + a] * u[0];
  }
  for (std::size_t i = first_; i < tree_.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      s.pull[3 * i + a] -= weight_[i] * shared[a] + turned[3 * a] * weight_x_[i] +
                           turned[3 * a + 1] * weight_y_[i] + turned[3 * a + 2] * weight_z_[i];
}

/// Σ pull · ∂²(local position)/∂t_k∂t_l over all atoms into sum[width_ k + l], for l >= k. With
/// e = x × S, and the frames' angular velocities w_k, a bond adds (S · ∂²(length x), Q · ∂²w):
///   stretch_k w_l·e + stretch_l w_k·e + length ((w_l·S) (w_k·x) - (S·x) w_k·w_l)
///   + torsion_k w'_l·(x' × Q) + deflection_k w_l·(z × Q),   ' of the parent,
/// and the second derivatives of q, which only k = l has.
HAPGRID_WITH_AVX2
void Morph::sweep(Shape& s, double* sum) const {
  const std::size_t w = width_;
  std::fill(s.twist.begin(), s.twist.end(), 0.0);
  if (in_space_) {
    for (std::size_t i = 0; i < tree_.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a) s.weight[a * stride_ + i] = s.pull[3 * i + a];
  }
  for (std::size_t i = in_space_ ? 0 : tree_.size() - 1; i > 0; --i) {
    const auto parent = static_cast<std::size_t>(tree_.parent[i]);
    const double *x0 = &s.frame[9 * parent], *x = &s.frame[9 * i], *z = x + 6;
    const double* pull = &s.pull[3 * i];
    double* q = &s.twist[3 * i];
    const double length = s.q[i];
    double e[3], bend[3], fold[3];
    for (std::size_t a = 0; a < 3; ++a) {
      e[a] = x[(a + 1) % 3] * pull[(a + 2) % 3] - x[(a + 2) % 3] * pull[(a + 1) % 3];
      q[a] += length * e[a];
      s.pull[3 * parent + a] += pull[a];
      s.twist[3 * parent + a] += q[a];
    }
    for (std::size_t a = 0; a < 3; ++a) {
      bend[a] = x0[(a + 1) % 3] * q[(a + 2) % 3] - x0[(a + 2) % 3] * q[(a + 1) % 3];
      fold[a] = z[(a + 1) % 3] * q[(a + 2) % 3] - z[(a + 2) % 3] * q[(a + 1) % 3];
    }
    const double along = x[0] * pull[0] + x[1] * pull[1] + x[2] * pull[2];
    s.weight[i] = along;
    s.weight[stride_ + i] = z[0] * q[0] + z[1] * q[1] + z[2] * q[2];
    s.weight[2 * stride_ + i] = x0[0] * q[0] + x0[1] * q[1] + x0[2] * q[2];

    const double *from = &s.turning[3 * w * parent], *to = &s.turning[3 * w * i];
    const double *stretch = &s.rate[i * w], *deflection = &s.rate[(stride_ + i) * w],
                 *torsion = &s.rate[(2 * stride_ + i) * w];
    for (std::size_t l = 0; l < w; l += 4) {
      const Four t0 = load<Four>(to + l), t1 = load<Four>(to + w + l),
                 t2 = load<Four>(to + 2 * w + l);
      const Four swings = t0 * e[0] + t1 * e[1] + t2 * e[2];
      const Four pulls = length * (t0 * pull[0] + t1 * pull[1] + t2 * pull[2]);
      const Four bends = load<Four>(from + l) * bend[0] + load<Four>(from + w + l) * bend[1] +
                         load<Four>(from + 2 * w + l) * bend[2];
      const Four folds = t0 * fold[0] + t1 * fold[1] + t2 * fold[2];
      const Four stretches = load<Four>(stretch + l);
      for (std::size_t k = 0; k < l + 4; ++k) {
        const double k0 = to[k], k1 = to[w + k], k2 = to[2 * w + k];
        Four c = load<Four>(sum + k * w + l) + stretch[k] * swings +
                 (k0 * x[0] + k1 * x[1] + k2 * x[2]) * pulls + torsion[k] * bends +
                 deflection[k] * folds + (k0 * e[0] + k1 * e[1] + k2 * e[2]) * stretches -
                 length * along * (k0 * t0 + k1 * t1 + k2 * t2);
        store(sum + k * w + l, c);
      }
    }
  }
  const std::size_t coordinates = q0_.size();
  for (std::size_t k = 0; k < paths_.size(); ++k) {
    const Spline& path = paths_[k];
    const double squared = static_cast<double>(path.segments * path.segments);
    const auto [a, u] = path.piece(s.t[k], coordinates);
    Four second = {0, 0, 0, 0};
    for (std::size_t c = 0; c < coordinates; c += 4)
      second += load<Four>(&s.weight[c]) * (2 * load<Four>(a + 2 * coordinates + c) +
                                            (6 * u) * load<Four>(a + 3 * coordinates + c));
    sum[k * w + k] += squared * ((second[0] + second[1]) + (second[2] + second[3]));
  }
}

}  // namespace hapgrid::molecule
