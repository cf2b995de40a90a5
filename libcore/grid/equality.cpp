#include "libcore/grid/equality.hpp"

namespace hapgrid {

namespace {

double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

std::array<double, 3> cross(const double* a, const double* b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

double angle_between(const double* a, const double* b) {
  // Of two rotations whose matrices differ by D, the angle is 2 asin(|D| / (2 sqrt 2)) with the
  // norm of Frobenius, which is exact for small angles, too.
  const std::array<double, 3> a3 = cross(a, a + 3), b3 = cross(b, b + 3);
  double sum = 0;
  for (int k = 0; k < 6; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  for (int k = 0; k < 3; ++k) sum += (a3[k] - b3[k]) * (a3[k] - b3[k]);
  const double half = std::sqrt(sum / 8);
  return half < 1 ? 2 * std::asin(half) : half * 3.14159265358979323846;
}

void orthonormalise(double* columns) {
  double* const p = columns;
  double* const q = columns + 3;
  const double first = std::sqrt(dot(p, p));
  for (int k = 0; k < 3; ++k) p[k] /= first;
  const double along = dot(p, q);
  for (int k = 0; k < 3; ++k) q[k] -= along * p[k];
  const double second = std::sqrt(dot(q, q));
  for (int k = 0; k < 3; ++k) q[k] /= second;
  // Opposite orientations can cancel each other.
  if (first > 1e-6 && second > 1e-6) return;
  for (int k = 0; k < 6; ++k) columns[k] = k % 4 == 0;
}

void orthonormalise_rotations(const Equality& equality, std::span<double> row) noexcept {
  for (std::size_t c = 0; c < equality.periods.size(); ++c) {
    if (!equality.is_rotation(c)) continue;
    orthonormalise(&row[c]);
    c += 5;
  }
}

void blend_angles(const Equality& equality, const std::array<double, 8>& w,
                  const std::array<const double*, 8>& rows, std::span<double> row) noexcept {
  for (std::size_t c = 0; c < equality.periods.size(); ++c)
    for (int k = 1; k < 8 && equality.periods[c] > 0; ++k)
      row[c] += w[k] * (nearest(equality, c, rows[k][c], rows[0][c]) - rows[k][c]);
}

}  // namespace hapgrid
