// The energy that a table gives at any place, with its gradient.
#pragma once

#include <string>

#include "tools/apps/table/lattice.hpp"

namespace hapgrid::table {

struct FieldOptions {
  double factor = 1;  ///< values are multiplied by it
  double wall = 0;    ///< the height, in the energy's unit after `factor`
  bool has_wall = false;
};

/// Values that are higher than half way between the lowest value and the wall are pressed together
/// below the wall's height: c + (wall − c) (1 − exp(−(v − c) / (wall − c))). A spline through
/// values that jump by orders of magnitude would swing. A missing value is as high as the wall.
///
/// Outside the lattice the energy goes on in a straight line from the nearest place of the lattice,
/// by lattice coordinates, and rises by b (√(4 + q²) − 2) for q cells outside. b is twice what the
/// table rises by in a cell at most, so that the hand comes back. So a sheared table has energies
/// in all of the grid's box, with forces that do not jump.
class Field {
 public:
  /// @throw std::runtime_error when a value is missing and there is no wall, when all values lie
  /// above the wall, or when the energy is the same everywhere.
  Field(const Lattice& lattice, const FieldOptions& options, const std::string& name);

  /// The energy; `gradient` gets its gradient. Real-time safe.
  double at(const double* x, double* gradient) const;

  /// The largest length of the gradient at a point of the lattice.
  double steepest() const { return steepest_; }

  /// The lowest points of the lattice that have no lower one among their 26 neighbours, the lowest
  /// first.
  const std::vector<Vector>& minima() const { return minima_; }

 private:
  void find_steepest();
  void find_minima(const std::vector<double>& values);

  Lattice lattice_;  // without values and atoms
  Spline spline_;
  double rise_ = 0;  // energy, for a cell outside
  double steepest_ = 0;
  std::vector<Vector> minima_;
};

inline constexpr std::size_t kMostMinima = 12;

}  // namespace hapgrid::table
