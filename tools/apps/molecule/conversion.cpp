#include "tools/apps/molecule/conversion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hapgrid::molecule {

namespace {

// A minimum without contact counts as a molecule at rest when no scaled variable is farther from
// that, Å.
constexpr double kSnap = 0.01;
// A variable that goes farther than this, Å, between two minimisations has left its branch. Where a
// branch ends decides where the molecule comes to rest, so this move of the HIP is made once more
// in so many pieces.
constexpr double kLeap = 0.15;
constexpr int kPieces = 8;

}  // namespace

double rounded_state(double v) {
  // A value so large that a double's digits do not reach down to the unit is left alone. No
  // stiffness allows such a state.
  constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52
  const double units = v / kStateUnit;
  if (!(std::abs(units) < 0x1p50)) return v;
  return ((units + kRound) - kRound) * kStateUnit + 0.0;  // + 0.0: never -0
}

Conversion::Conversion(const Molecule& molecule, HybridEnergy& energy, double substep,
                       const MinimiserLimits& limits)
    : energy_(energy), substep_(substep), minima_(molecule, energy), minimiser_(energy, limits) {}

void Conversion::convert(const double* s, const double* x, const double* d, double* result) {
  const std::size_t n = energy_.variables();
  std::array<double, kMaxVariables> state;
  for (std::size_t i = 0; i < n; ++i) {
    state[i] = i < energy_.morph().paths() ? energy_.inside(i, s[i]) : s[i];
  }
  const std::size_t none = minima_.size();
  std::size_t rest = minima_.near(state.data(), 0);
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  // There is at least one substep: a state that is given need not be a minimum.
  const double substeps = std::max(1.0, std::ceil(length / substep_));
  const double move[3] = {d[0] / substeps, d[1] / substeps, d[2] / substeps};
  if (rest == none) minimiser_.start(state.data(), x);
  for (double step = 1; step <= substeps; ++step) {
    const double f = step / substeps;
    const double p[3] = {x[0] + f * d[0], x[1] + f * d[1], x[2] + f * d[2]};
    // Without contact it is a minimum already. Most conversions end there.
    if (rest != none && !minima_.touched(rest, p)) continue;
    if (rest != none)
      minimiser_.minimise(state.data(), p, step == substeps);
    else
      follow(state.data(), p, move, step == substeps);
    rest = none;
    if (energy_.touches()) continue;
    const std::size_t nearest = minima_.near(state.data(), kSnap);
    if (nearest == none || minima_.touched(nearest, p)) continue;
    std::copy_n(minima_.state(nearest).begin(), n, state.begin());
    rest = nearest;
  }
  for (std::size_t i = 0; i < n; ++i)
    result[i] = rounded_state(i < energy_.morph().paths() ? energy_.inside(i, state[i]) : state[i]);
}

void Conversion::follow(double* state, const double* x, const double* move, bool last) {
  const std::size_t n = energy_.variables();
  std::array<double, kMaxVariables> before{};
  std::copy_n(state, n, before.begin());
  minimiser_.follow(state, x, move, last);
  double farthest = 0;
  for (std::size_t i = 0; i < n; ++i)
    farthest = std::max(farthest, std::abs(state[i] - before[i]) * energy_.scale(i));
  if (farthest <= kLeap) return;
  std::copy_n(before.begin(), n, state);
  const double piece[3] = {move[0] / kPieces, move[1] / kPieces, move[2] / kPieces};
  double at[3] = {x[0] - move[0], x[1] - move[1], x[2] - move[2]};
  minimiser_.start(state, at);
  for (int k = kPieces - 1; k >= 0; --k) {
    for (int a = 0; a < 3; ++a) at[a] = x[a] - k * piece[a];
    minimiser_.follow(state, at, piece, last || k > 0);
  }
}

}  // namespace hapgrid::molecule
