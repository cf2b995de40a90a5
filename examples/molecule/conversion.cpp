#include "examples/molecule/conversion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hapgrid::molecule {

namespace {

// A minimum without contact counts as the state 0 when no scaled variable is farther from 0, Å.
constexpr double kSnap = 0.01;

double rounded(double v) {
  // A value so large that a double's digits do not reach down to the unit is left alone. No
  // stiffness allows such a state.
  constexpr double kRound = 6755399441055744.0;  // 1.5 * 2^52
  const double units = v / kStateUnit;
  if (!(std::abs(units) < 0x1p50)) return v;
  return ((units + kRound) - kRound) * kStateUnit + 0.0;  // + 0.0: never -0
}

}  // namespace

Conversion::Conversion(HybridEnergy& energy, double substep, const MinimiserLimits& limits)
    : energy_(energy), substep_(substep), minimiser_(energy, limits) {}

void Conversion::convert(const double* s, const double* x, const double* d, double* result) {
  const std::size_t n = energy_.variables();
  std::array<double, kMaxVariables> state;
  for (std::size_t i = 0; i < n; ++i) {
    const bool morphs = i < energy_.morph().paths();
    state[i] = morphs ? std::clamp(s[i], 0.0, 1.0) : s[i];
  }
  bool at_rest = std::all_of(state.begin(), state.begin() + n, [](double v) { return v == 0; });
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  // There is at least one substep: a state that is given need not be a minimum.
  const double substeps = std::max(1.0, std::ceil(length / substep_));
  const double move[3] = {d[0] / substeps, d[1] / substeps, d[2] / substeps};
  if (!at_rest) minimiser_.start(state.data(), x);
  for (double step = 1; step <= substeps; ++step) {
    const double f = step / substeps;
    const double p[3] = {x[0] + f * d[0], x[1] + f * d[1], x[2] + f * d[2]};
    // Without contact the state 0 is a minimum, with no energy at all. Most conversions end there.
    if (at_rest && !energy_.touches_conformation(p)) continue;
    if (at_rest)
      minimiser_.minimise(state.data(), p, step == substeps);
    else
      minimiser_.follow(state.data(), p, move, step == substeps);
    at_rest = false;
    if (energy_.touches() || energy_.touches_conformation(p)) continue;
    double distance = 0;
    for (std::size_t i = 0; i < n; ++i)
      distance = std::max(distance, std::abs(state[i] * energy_.scale(i)));
    if (distance > kSnap) continue;
    std::fill_n(state.begin(), n, 0.0);
    at_rest = true;
  }
  for (std::size_t i = 0; i < n; ++i) result[i] = rounded(state[i]);
}

}  // namespace hapgrid::molecule
