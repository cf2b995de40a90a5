// The shapes in which the molecule rests when nothing touches it: the conformation and, where paths
// go on behind their saddles, the minima there and all combinations of them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tools/apps/molecule/energy.hpp"

namespace hapgrid::molecule {

/// The most shapes. A point that nothing touches has a level for each, and levels are limited.
inline constexpr std::size_t kMaxMinima = 64;

/// The t of all combinations of the paths' minima, or of each path's alone where bonds break and
/// form; the first is the conformation, all 0. There are at most kMaxMinima + 1.
std::vector<std::vector<double>> combined_minima(const Molecule& molecule);

/// Real-time safe after construction.
class Minima {
 public:
  Minima(const Molecule& molecule, HybridEnergy& energy);

  std::size_t size() const { return states_.size(); }
  /// A state at rest: t of the shape, rounded as the conversion rounds; no shift and no rotation.
  const std::vector<double>& state(std::size_t minimum) const { return states_[minimum]; }
  /// The centre of these atoms in this shape, Å.
  std::array<double, 3> centre(std::size_t minimum, const std::vector<int>& atoms) const;
  /// Whether the probe at x touches an atom of this shape. An atom that is held is always touched.
  bool touched(std::size_t minimum, const double* x) const;
  /// The minimum from which no variable, times its scale, is farther than `limit`, Å; size() when
  /// there is none.
  std::size_t near(const double* s, double limit) const;

 private:
  /// On the shorter way round where a path closes.
  double difference(std::size_t i, double d) const {
    return i < closes_.size() && closes_[i] ? d - std::round(d) : d;
  }

  std::vector<bool> closes_;  // of each path
  std::vector<std::vector<double>> states_;
  std::vector<double> scale_;
  bool held_ = false;                           // the hand holds an atom
  std::vector<double> reach_;                   // an atom's and the probe's radius, Å
  std::vector<std::vector<double>> positions_;  // of each minimum, 3 an atom, Å
};

}  // namespace hapgrid::molecule
