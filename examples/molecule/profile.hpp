// The energy along one path: cubics through the nodes' energies, without extrema between the nodes.
#pragma once

#include <vector>

namespace hapgrid::molecule {

/// Source: Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238, with the harmonic mean of the
/// neighbouring slopes (PCHIP). The profile is once continuously differentiable, and flat at both
/// ends, since a conformation and a transition state are stationary.
class Profile {
 public:
  struct Value {
    double energy, slope, curvature;  // kJ/mol; per unit of t; per unit of t squared
  };

  /// @param energies kJ/mol at equidistant t from 0 to 1, at least 2.
  explicit Profile(const std::vector<double>& energies);

  /// For t in [0, 1]; exact at the nodes, where the curvature is that of the segment of larger t.
  /// Real-time safe.
  Value at(double t) const;

 private:
  struct Segment {
    double a[4];  // powers of u in [0, 1]
  };
  std::vector<Segment> segments_;
  double last_;
};

}  // namespace hapgrid::molecule
