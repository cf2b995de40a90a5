// A smooth function through values on a lattice: the tricubic spline, which has continuous second
// derivatives, so that the force is exactly the gradient of the energy and is smooth itself.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace hapgrid::table {

/// Along each axis the spline is "not-a-knot": it reproduces every polynomial of degree 3 exactly,
/// up to the edge. Source: de Boor, A Practical Guide to Splines, 1978, Sect. IV.
class Spline {
 public:
  using Counts = std::array<std::size_t, 3>;

  /// What the spline is at one place. Derivatives are by lattice coordinates.
  struct Value {
    double value = 0;
    std::array<double, 3> gradient{};
    std::array<double, 6> hessian{};  ///< xx yy zz xy xz yz; left at zero unless it is asked for
  };

  static constexpr std::size_t kLeastPoints = 4;

  Spline() = default;
  /// @param counts of points, each at least kLeastPoints.
  /// @param values all finite, x fastest.
  Spline(const Counts& counts, const std::vector<double>& values);

  /// @param u lattice coordinates, 0 … count − 1 along each axis; a place outside is moved to the
  /// edge. Real-time safe.
  Value at(const std::array<double, 3>& u, bool with_hessian = false) const;

  const Counts& counts() const { return counts_; }

 private:
  Counts counts_{};
  std::vector<double> coefficients_;  ///< of the B-splines, counts + 2 along each axis, x fastest
};

}  // namespace hapgrid::table
