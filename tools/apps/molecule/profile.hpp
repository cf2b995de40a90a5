// The energy along one path: cubics through the nodes' energies, without extrema between the nodes.
#pragma once

#include <cstddef>
#include <vector>

namespace hapgrid::molecule {

/// Source: Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238, with the harmonic mean of the
/// neighbouring slopes (PCHIP). The profile is once continuously differentiable, and flat at both
/// ends, since a conformation and a transition state are stationary. So are the minima and saddles
/// inside a path.
class Profile {
 public:
  struct Value {
    double energy, slope, curvature;  // kJ/mol; per unit of t; per unit of t squared
  };

  /// @param energies kJ/mol at equidistant t, at least 2
  /// @param start the one at t = 0; from the first to the last t grows by 1
  explicit Profile(const std::vector<double>& energies, std::size_t start = 0);

  /// For t between the ends; exact at the nodes, where the curvature is that of the segment of
  /// larger t. Real-time safe.
  Value at(double t) const;

 private:
  struct Segment {
    double a[4];  // powers of u in [0, 1]
  };
  std::vector<Segment> segments_;
  double first_;  // segments before t = 0
  double last_;
};

}  // namespace hapgrid::molecule
