// A simulated hand that holds a device whose forces come from a grid, in virtual time: what the
// benches of closed loops share.
#pragma once

#include <atomic>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "libcore/follow/beside.hpp"
#include "libcore/follow/branch_traversal.hpp"
#include "libcore/follow/node_force.hpp"
#include "libcore/follow/record_fields.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/loop/loop.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/simulated.hpp"

namespace hapgrid::bench {

constexpr double kReach = 0.1;  // m, of the box's longest side
constexpr int kRate = 1000;

/// A place of the box, in metres from its middle.
inline Vec3 somewhere(const Box& box, std::mt19937_64& random) {
  const int longest = std::max({box.counts[0], box.counts[1], box.counts[2]});
  Vec3 x;
  for (int a = 0; a < 3; ++a)
    x[a] = kReach / 2 * uniform(random, -1, 1) * (box.counts[a] - 1) / (longest - 1);
  return x;
}

/// Appends a way of least jerk from the last target. @param speed in the mean, m/s
inline void move_to(std::vector<Vec3>& targets, const Vec3& at, double speed) {
  const Vec3 from = targets.back();
  const double ticks = length_of(at - from) / speed * kRate;
  for (double i = 0; i < ticks; ++i) {
    const double t = i / ticks;
    targets.push_back(from + t * t * t * (10 - 15 * t + 6 * t * t) * (at - from));
  }
  targets.push_back(at);
}

inline void rest(std::vector<Vec3>& targets, double seconds) {
  const Vec3 at = targets.back();
  targets.resize(targets.size() + static_cast<std::size_t>(seconds * kRate), at);
}

/// Adds a sine of 8 to 12 Hz on each axis. @param size m @param phase in [0, 1): draws them
inline void tremble(std::vector<Vec3>& targets, double size, double phase) {
  for (std::size_t i = 0; i < targets.size(); ++i)
    for (int a = 0; a < 3; ++a) {
      const double hertz = 8 + std::fmod(phase * (a + 1), 1.0) * 4;
      targets[i][a] +=
          size * std::sin(2 * std::numbers::pi * hertz * static_cast<double>(i) / kRate);
    }
}

/// Plays one grid with the default rules.
class Player {
 public:
  Player(const Grid& grid, const MakeModel& make)
      : grid_(grid),
        make_(make),
        map_(std::make_shared<const BranchNodes>(grid)),
        energies_(std::make_shared<const NodeEnergies>(
            node_energies(grid, record_fields(grid, make, 2), map_.get()))) {}

  /// @param late by how many ticks answers of the model beside the grid are; nothing: without it
  /// @param sink (const Tick&, const SimulatedDevice&, const SafetyCore&), in each tick
  template <class Sink>
  void play(const SimulatedOptions& options, const std::vector<Vec3>& targets,
            const SafetyLimits& limits, std::optional<std::uint32_t> late, const Sink& sink) const {
    SimulatedDevice device(options, [&](std::uint64_t, std::vector<Vec3>& to) { to = targets; });
    Mapping mapping({}, device.info(), grid_.box());
    BranchTraversal traversal(grid_, map_);
    std::optional<Beside> beside;
    if (late) {
      beside.emplace(grid_, make_(), late);
      beside->begin(kRate);
      traversal.walk_beside(&*beside);
    }
    SafetyCore safety(limits);
    struct Force {
      NodeForce force;
      double metres;
      Vec3 operator()(const Traversal& t) { return force(t); }
      double model_energy(const Traversal& t) const { return force.energy(t) * metres; }
      std::optional<double> account(const Traversal& t) const { return force.account(t) * metres; }
    } force{NodeForce(energies_, grid_.box(), hermite_force), limits.gain / mapping.scale()};
    std::atomic<int> stop{0};
    std::atomic<std::uint64_t> beat{0};
    run_loop(
        device, mapping, traversal, safety, force,
        [&](const Tick& tick) { sink(tick, device, safety); }, stop, beat);
  }

 private:
  const Grid& grid_;
  MakeModel make_;
  std::shared_ptr<const BranchNodes> map_;
  std::shared_ptr<const NodeEnergies> energies_;
};

}  // namespace hapgrid::bench
