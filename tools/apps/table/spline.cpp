#include "tools/apps/table/spline.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hapgrid::table {

namespace {

/// The coefficients c[0 … n + 1] of the B-splines through f[0 … n − 1]: coefficient k belongs to
/// the B-spline around point k − 1, and (c[k] + 4 c[k + 1] + c[k + 2]) / 6 = f[k]. Not-a-knot: the
/// third derivative is continuous at the second point, c[0] − 4 c[1] + 6 c[2] − 4 c[3] + c[4] = 0.
/// With the equations of the first three points this leaves c[2] = (8 f[1] − f[0] − f[2]) / 6, and
/// the same holds at the other end.
void solve(const double* f, std::size_t n, double* c, double* scratch) {
  c[2] = (8 * f[1] - f[0] - f[2]) / 6;
  c[n - 1] = (8 * f[n - 2] - f[n - 1] - f[n - 3]) / 6;
  // c[3 … n − 2]: a tridiagonal system, 1 4 1, between two known ends.
  double left = c[2], ratio = 0;
  for (std::size_t k = 3; k + 1 < n; ++k) {
    scratch[k] = ratio = 1 / (4 - ratio);
    c[k] = left = (6 * f[k - 1] - left) * ratio;
  }
  for (std::size_t k = n - 2; k >= 3; --k) c[k] -= scratch[k] * c[k + 1];
  c[1] = 6 * f[1] - 4 * c[2] - c[3];
  c[0] = 6 * f[0] - 4 * c[1] - c[2];
  c[n] = 6 * f[n - 2] - 4 * c[n - 1] - c[n - 2];
  c[n + 1] = 6 * f[n - 1] - 4 * c[n] - c[n - 1];
}

/// The four B-splines that are not zero between two points, and their derivatives; t in [0, 1].
void weights(double t, double w[4], double d[4], double dd[4]) {
  const double s = 1 - t;
  w[0] = s * s * s / 6;
  w[1] = (4 - 3 * t * t * (2 - t)) / 6;
  w[2] = (4 - 3 * s * s * (2 - s)) / 6;
  w[3] = t * t * t / 6;
  d[0] = -s * s / 2;
  d[1] = t * (3 * t - 4) / 2;
  d[2] = s * (4 - 3 * s) / 2;
  d[3] = t * t / 2;
  dd[0] = s;
  dd[1] = 3 * t - 2;
  dd[2] = 3 * s - 2;
  dd[3] = t;
}

}  // namespace

Spline::Spline(const Counts& counts, const std::vector<double>& values) : counts_(counts) {
  assert(values.size() == counts[0] * counts[1] * counts[2]);
  // One axis after the other: each line of values along it becomes a line of coefficients.
  std::vector<double> from = values, to;
  Counts size = counts;
  const std::size_t longest = *std::max_element(counts.begin(), counts.end());
  std::vector<double> f(longest), c(longest + 2), scratch(longest + 2);
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t n = size[axis];
    assert(n >= kLeastPoints);
    const std::size_t inner = axis == 0 ? 1 : axis == 1 ? size[0] : size[0] * size[1];
    const std::size_t outer = from.size() / (inner * n);
    to.assign(inner * (n + 2) * outer, 0);
    for (std::size_t o = 0; o < outer; ++o)
      for (std::size_t i = 0; i < inner; ++i) {
        for (std::size_t k = 0; k < n; ++k) f[k] = from[(o * n + k) * inner + i];
        solve(f.data(), n, c.data(), scratch.data());
        for (std::size_t k = 0; k < n + 2; ++k) to[(o * (n + 2) + k) * inner + i] = c[k];
      }
    size[axis] = n + 2;
    from.swap(to);
  }
  coefficients_ = std::move(from);
}

Spline::Value Spline::at(const std::array<double, 3>& u, bool with_hessian) const {
  std::array<std::size_t, 3> cell;
  double w[3][4], d[3][4], dd[3][4];
  for (int a = 0; a < 3; ++a) {
    const double last = static_cast<double>(counts_[a] - 1);
    // Not std::clamp, which lets a NaN pass.
    const double inside = u[a] > 0 ? std::min(u[a], last) : 0.0;
    cell[a] = std::min(static_cast<std::size_t>(inside), counts_[a] - 2);
    weights(inside - static_cast<double>(cell[a]), w[a], d[a], dd[a]);
  }
  const std::size_t row = counts_[0] + 2, plane = row * (counts_[1] + 2);
  Value out;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) {
      const double* c = &coefficients_[(cell[2] + static_cast<std::size_t>(k)) * plane +
                                       (cell[1] + static_cast<std::size_t>(j)) * row + cell[0]];
      double v = 0, vx = 0;
      for (int i = 0; i < 4; ++i) v += w[0][i] * c[i], vx += d[0][i] * c[i];
      const double jk = w[1][j] * w[2][k];
      out.value += jk * v;
      out.gradient[0] += jk * vx;
      out.gradient[1] += d[1][j] * w[2][k] * v;
      out.gradient[2] += w[1][j] * d[2][k] * v;
      if (!with_hessian) continue;
      double vxx = 0;
      for (int i = 0; i < 4; ++i) vxx += dd[0][i] * c[i];
      out.hessian[0] += jk * vxx;
      out.hessian[1] += dd[1][j] * w[2][k] * v;
      out.hessian[2] += w[1][j] * dd[2][k] * v;
      out.hessian[3] += d[1][j] * w[2][k] * vx;
      out.hessian[4] += w[1][j] * d[2][k] * vx;
      out.hessian[5] += d[1][j] * d[2][k] * v;
    }
  return out;
}

}  // namespace hapgrid::table
