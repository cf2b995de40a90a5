// What the molecule model costs: a shape and a force in the haptic loop (77 atoms, 4 paths), the
// hybrid energy with its derivatives and a conversion in the search. The column CPU counts.
#include <benchmark/benchmark.h>

#include <cmath>

#include "examples/molecule/conversion.hpp"
#include "tests/unit/molecule/reference.hpp"

namespace {

using namespace molecules;

const Source& source(const benchmark::State& state) {
  return state.range(0) == 77 ? kEnkephalin : kDipeptide;
}

std::vector<std::vector<double>> states(const HybridEnergy& energy) {
  Random random(1);
  std::vector<std::vector<double>> states;
  for (int i = 0; i < 64; ++i) {
    states.push_back(random.state(energy));
    for (std::size_t k = 0; k < energy.morph().paths(); ++k) states[i][k] = random.between(0, 1);
  }
  return states;
}

constexpr double kInside[3] = {0.5, 0.3, 2.5};

void shape_and_force(benchmark::State& state) {
  HybridEnergy energy(source(state).read(), {});
  const auto s = states(energy);
  std::vector<float> centres(3 * energy.morph().atoms());
  double f[3];
  std::size_t i = 0;
  for (auto _ : state) {
    const double* at = s[++i % s.size()].data();
    energy.force(at, kInside, f);
    energy.positions(at, centres.data());
    benchmark::DoNotOptimize(f);
    benchmark::DoNotOptimize(centres.data());
  }
}

void energy_and_derivatives(benchmark::State& state) {
  HybridEnergy energy(source(state).read(), {});
  const auto s = states(energy);
  const std::size_t n = energy.variables();
  std::vector<double> g(n), h(n * n);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(energy.value(s[++i % s.size()].data(), kInside));
    energy.derivatives(g.data(), h.data(), state.range(1) != 0);
    benchmark::DoNotOptimize(h.data());
  }
}

/// A random walk of the HIP in steps of 0.75 Å through the molecule's surroundings.
void conversion(benchmark::State& state) {
  HybridEnergy energy(source(state).read(), {});
  hapgrid::molecule::Conversion conversion(energy, 0.1, {});
  Random random(2);
  std::vector<double> s(energy.variables());
  const double reach = 2 * energy.morph().gyration();
  double x[3] = {reach, reach, reach};
  Eigen::Vector3d heading(-1, -1, -1);
  for (auto _ : state) {
    double d[3];
    for (int a = 0; a < 3; ++a) heading[a] += random.between(-0.5, 0.5);
    heading.normalize();
    for (int a = 0; a < 3; ++a) {
      if (std::abs(x[a] + 0.75 * heading[a]) > reach) heading[a] = -heading[a];
      d[a] = 0.75 * heading[a];
    }
    conversion.convert(s.data(), x, d, s.data());
    for (int a = 0; a < 3; ++a) x[a] += d[a];
  }
  const auto& work = conversion.work();
  state.counters["minimisations"] =
      static_cast<double>(work.minimisations) / static_cast<double>(work.conversions);
  state.counters["evaluations/minimisation"] =
      static_cast<double>(work.evaluations) / static_cast<double>(work.minimisations);
}

BENCHMARK(shape_and_force)->ArgName("atoms")->Arg(22)->Arg(77);
BENCHMARK(energy_and_derivatives)
    ->ArgNames({"atoms", "anew"})
    ->Args({22, 0})
    ->Args({22, 1})
    ->Args({77, 0})
    ->Args({77, 1});
BENCHMARK(conversion)->ArgName("atoms")->Arg(22)->Arg(77)->Iterations(20000);

}  // namespace

BENCHMARK_MAIN();
