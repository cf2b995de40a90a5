// How the shape changes with t: see morph.hpp.
#include <algorithm>

#include "examples/molecule/morph.hpp"

namespace hapgrid::molecule {

/// From velocities v of the atoms: sum[3 a + b] = Σ m v_a c_b, and the velocity of the centre of
/// mass. Each component of a velocity has `stride` numbers; those at `at` and `at` + 1 are taken.
Morph::Moments Morph::moments(const std::vector<double>& velocities, std::size_t stride,
                              std::size_t at) const {
  Moments m{};
  for (std::size_t i = 1; i < tree_.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      const Two v = load(&velocities[(3 * i + a) * stride + at]);
      m.sum[3 * a] += v * mass_x_[i];
      m.sum[3 * a + 1] += v * mass_y_[i];
      m.sum[3 * a + 2] += v * mass_z_[i];
      m.centre[a] += v * mass_[i];
    }
  }
  for (Two& c : m.centre) c = c / total_mass_;
  return m;
}

/// When A changes by p the alignment has a torque; this finds the turn that removes it.
void Morph::turn_back(const Shape& s, const Two* p, double* turn, std::size_t stride) {
  const Two torque[3] = {p[7] - p[5], p[2] - p[6], p[3] - p[1]};
  for (std::size_t a = 0; a < 3; ++a)
    store(turn + a * stride, -(s.inverse[3 * a] * torque[0] + s.inverse[3 * a + 1] * torque[1] +
                               s.inverse[3 * a + 2] * torque[2]));
}

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
    for (std::size_t c = 0; c < coordinates; c += 2) {
      const Two rate = f1 * load(a + coordinates + c) + f2 * load(a + 2 * coordinates + c) +
                       f3 * load(a + 3 * coordinates + c);
      s.rate[c * w + k] = rate[0];
      s.rate[(c + 1) * w + k] = rate[1];
    }
  }
  differentiate_tree(s);
  // The alignment follows: with W = Σ m v cᵀ (v local), A changes by R W and the torque by
  // Σ m c × (R v), which (tr(A) 1 - A) ω removes.
  const std::array<double, 9>& r = s.rotation;
  for (std::size_t k = 0; k < w; k += 2) {
    const auto [sum, centre] = moments(s.moving, w, k);
    for (std::size_t a = 0; a < 3; ++a) store(&s.centre_moving[a * w + k], centre[a]);
    Two p[9];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        p[3 * i + j] = r[3 * i] * sum[j] + r[3 * i + 1] * sum[3 + j] + r[3 * i + 2] * sum[6 + j];
    for (std::size_t a = 0; a < 9; ++a) store(&s.overlap_rate[a * w + k], p[a]);
    turn_back(s, p, &s.aligning[k], w);
  }
}

/// A frame turns with its parent's frame, about the parent's x with the torsion, and about its own
/// z with the deflection. All paths are computed at once, two in a vector.
void Morph::differentiate_tree(Shape& s) const {
  const std::size_t w = width_;
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
    for (std::size_t k = 0; k < w; k += 2) {
      const Two torsion = load(torsion_rate + k), deflection = load(deflection_rate + k),
                stretch = load(length_rate + k);
      const Two w0 = load(turning_from + k) + torsion * from[0] + deflection * to[6];
      const Two w1 = load(turning_from + w + k) + torsion * from[1] + deflection * to[7];
      const Two w2 = load(turning_from + 2 * w + k) + torsion * from[2] + deflection * to[8];
      store(turning + k, w0);
      store(turning + w + k, w1);
      store(turning + 2 * w + k, w2);
      store(moving + k,
            load(moving_from + k) + stretch * to[0] + length * (w1 * to[2] - w2 * to[1]));
      store(moving + w + k,
            load(moving_from + w + k) + stretch * to[1] + length * (w2 * to[0] - w0 * to[2]));
      store(moving + 2 * w + k,
            load(moving_from + 2 * w + k) + stretch * to[2] + length * (w0 * to[1] - w1 * to[0]));
    }
  }
}

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

// The derivatives by t_l of what differentiate() computes for t_k, term by term. Paths add up in q,
// so only k = l has second derivatives of q.
void Morph::differentiate_twice(Shape& s) const {
  if (s.derivatives >= 2 || paths_.empty()) return;
  s.derivatives = 2;
  const std::size_t w = width_, paths = paths_.size(), pairs = paths * w;
  const std::size_t coordinates = q0_.size();
  for (std::size_t k = 0; k < paths; ++k) {
    const Spline& path = paths_[k];
    const double segments = static_cast<double>(path.segments);
    const auto [a, u] = path.piece(s.t[k], coordinates);
    const double f2 = 2 * segments * segments, f3 = 6 * u * segments * segments;
    for (std::size_t c = 0; c < coordinates; ++c)
      s.rate_rate[c * w + k] = f2 * a[2 * coordinates + c] + f3 * a[3 * coordinates + c];
  }
  differentiate_tree_twice(s);
  const std::array<double, 9>& r = s.rotation;
  for (std::size_t k = 0; k < paths; ++k) {
    for (std::size_t l = k - k % 2; l < w; l += 2) {
      const std::size_t at = k * w + l;
      const auto [sum, centre] = moments(s.moving_moving, pairs, at);
      for (std::size_t a = 0; a < 3; ++a) store(&s.centre_moving_moving[a * pairs + at], centre[a]);
      // R W + [ω_l] P_k + [ω_k] (P_l + [ω_l] A)
      double wk[3], pk[9];
      Two wl[3], pl[9], p[9];
      for (std::size_t a = 0; a < 3; ++a) {
        wk[a] = s.aligning[a * w + k];
        wl[a] = load(&s.aligning[a * w + l]);
      }
      for (std::size_t a = 0; a < 9; ++a) {
        pk[a] = s.overlap_rate[a * w + k];
        pl[a] = load(&s.overlap_rate[a * w + l]);
      }
      for (std::size_t j = 0; j < 3; ++j) {
        Two turned[3];
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
          turned[a] = pl[3 * a + j] + wl[b] * s.overlap[3 * c + j] - wl[c] * s.overlap[3 * b + j];
        }
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
          p[3 * a + j] = r[3 * a] * sum[j] + r[3 * a + 1] * sum[3 + j] + r[3 * a + 2] * sum[6 + j] +
                         wl[b] * pk[3 * c + j] - wl[c] * pk[3 * b + j] + wk[b] * turned[c] -
                         wk[c] * turned[b];
        }
      }
      turn_back(s, p, &s.aligning_aligning[at], pairs);
    }
  }
}

void Morph::differentiate_tree_twice(Shape& s) const {
  const std::size_t w = width_, paths = paths_.size(), pairs = paths * w;
  std::fill_n(s.turning_turning.begin(), 3 * pairs, 0.0);
  std::fill_n(s.moving_moving.begin(), 3 * pairs, 0.0);
  for (std::size_t i = 1; i < tree_.size(); ++i) {
    const auto parent = static_cast<std::size_t>(tree_.parent[i]);
    const double* x0 = &s.frame[9 * parent];
    const double* x = &s.frame[9 * i];
    const double* z = x + 6;
    const double* turning_from = &s.turning[3 * w * parent];
    const double* turning = &s.turning[3 * w * i];
    const std::size_t of_length = i * w, of_deflection = (stride_ + i) * w,
                      of_torsion = (2 * stride_ + i) * w;
    const double length = s.q[i];
    for (std::size_t k = 0; k < paths; ++k) {
      const double torsion = s.rate[of_torsion + k], deflection = s.rate[of_deflection + k],
                   stretch = s.rate[of_length + k];
      const double wk[3] = {turning[k], turning[w + k], turning[2 * w + k]};
      for (std::size_t l = k - k % 2; l < w; l += 2) {
        const Two same = {l == k ? 1.0 : 0.0, l + 1 == k ? 1.0 : 0.0};
        const std::size_t at = k * w + l;
        const Two from[3] = {load(turning_from + l), load(turning_from + w + l),
                             load(turning_from + 2 * w + l)};
        const Two wl[3] = {load(turning + l), load(turning + w + l), load(turning + 2 * w + l)};
        const Two bends = same * s.rate_rate[of_torsion + k],
                  folds = same * s.rate_rate[of_deflection + k],
                  grows = same * s.rate_rate[of_length + k],
                  stretch_l = load(&s.rate[of_length + l]);
        Two turn[3], along[3];
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
          turn[a] = load(&s.turning_turning[(3 * parent + a) * pairs + at]) + bends * x0[a] +
                    torsion * (from[b] * x0[c] - from[c] * x0[b]) + folds * z[a] +
                    deflection * (wl[b] * z[c] - wl[c] * z[b]);
          store(&s.turning_turning[(3 * i + a) * pairs + at], turn[a]);
          along[a] = wl[b] * x[c] - wl[c] * x[b];
        }
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
          const Two move =
              grows * x[a] + stretch * along[a] + stretch_l * (wk[b] * x[c] - wk[c] * x[b]) +
              length * (turn[b] * x[c] - turn[c] * x[b] + wk[b] * along[c] - wk[c] * along[b]);
          store(&s.moving_moving[(3 * i + a) * pairs + at],
                load(&s.moving_moving[(3 * parent + a) * pairs + at]) + move);
        }
      }
    }
  }
}

void Morph::curvature(const Shape& s, std::size_t i, const double* normal, double* out) const {
  const std::size_t w = width_, paths = paths_.size(), pairs = paths * w;
  const std::array<double, 9>& r = s.rotation;
  const double position[3] = {s.x[i], s.y[i], s.z[i]};
  double local_normal[3];  // Rᵀ n
  for (std::size_t a = 0; a < 3; ++a)
    local_normal[a] = r[a] * normal[0] + r[3 + a] * normal[1] + r[6 + a] * normal[2];
  double turned[kMaxPaths][3];  // R v, centred
  double across[kMaxPaths][3];  // n x ω_k: n · (ω_k x b) = (n x ω_k) · b
  for (std::size_t k = 0; k < paths; ++k) {
    double v[3];
    for (std::size_t a = 0; a < 3; ++a)
      v[a] = s.moving[(3 * i + a) * w + k] - s.centre_moving[a * w + k];
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      turned[k][a] = r[3 * a] * v[0] + r[3 * a + 1] * v[1] + r[3 * a + 2] * v[2];
      across[k][a] = normal[b] * s.aligning[c * w + k] - normal[c] * s.aligning[b * w + k];
    }
  }
  for (std::size_t k = 0; k < paths; ++k) {
    for (std::size_t l = k; l < paths; ++l) {
      const std::size_t at = k * w + l;
      double sum = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        const double moved = turned[l][a] + s.aligning[b * w + l] * position[c] -
                             s.aligning[c * w + l] * position[b];
        sum += local_normal[a] * (s.moving_moving[(3 * i + a) * pairs + at] -
                                  s.centre_moving_moving[a * pairs + at]) +
               across[l][a] * turned[k][a] + across[k][a] * moved +
               normal[a] * (s.aligning_aligning[b * pairs + at] * position[c] -
                            s.aligning_aligning[c * pairs + at] * position[b]);
      }
      out[k * paths + l] = out[l * paths + k] = sum;
    }
  }
}

}  // namespace hapgrid::molecule
