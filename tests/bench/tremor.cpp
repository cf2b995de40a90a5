// Whether a contact that a trembling hand holds keeps its force, with the energy tank and without.
//
//   bench_tremor GRID MODELS TREMOR STIFFNESS GAIN START [CONTACTS] [SECONDS] [SEED] [DELAY] [LATE]
//
// MODELS is the directory of the plug-ins. The hand, a spring of STIFFNESS (N/m) and a damper of
// 1.5 N s/m, holds a handle of 0.1 kg with an encoder of 5.5e-5 m. It goes to a random place of the
// box and holds there for SECONDS (60), or begins there (START: approach or contact). On each axis
// its point moves by a sine of TREMOR (mm) and 8 to 12 Hz. A place in the box is a contact if the
// hand feels 0.1 to 2.5 N there and the loop without a tank is stable: without tremor the force
// comes to rest, and with it the state does not snap. CONTACTS (20) of them are tried, with forces
// that come DELAY (0) ticks later than declared. The grid is alone, or the model walks beside it
// and its answers are LATE ticks late.
//
// A line: tremor, stiffness, gain, start; contacts; how many of them feel less than 95 % of the
// force before the core, at the end; the lowest such part; how many have swings of the force of
// more than 1.2 times those without the tank (and more than 0.01 N); the largest such ratio; the
// longest time until the force is full for a quarter of a second, in s.
#include <cstdlib>
#include <memory>
#include <numbers>
#include <optional>
#include <sstream>

#include "libcore/device/simulated.hpp"
#include "libcore/grid/vec3.hpp"
#include "libcore/haptic/branch_traversal.hpp"
#include "libcore/haptic/loop.hpp"
#include "libcore/haptic/node_force.hpp"
#include "libcore/haptic/record_fields.hpp"
#include "libcore/haptic/tear_function.hpp"
#include "tests/bench/bench.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

constexpr double kReach = 0.1;  // m
constexpr int kRate = 1000;

/// What a hand feels in a hold.
struct Held {
  double raw = 0, sent = 0;           // mean magnitude in the last tenth of the hold, N
  double low = 1e300, high = -1e300;  // of the magnitude that was sent, in the last third
  double full = 0;  // s until the force was 95 % of the wanted one, for a quarter of a second
  bool snapped = false;
  double swing() const { return high - low; }
};

struct Hand {
  double tremor, stiffness, gain;
  bool approaches;
  double seconds;
  std::uint32_t delay;
  std::optional<std::uint32_t> late;
};

class Player {
 public:
  Player(const Grid& grid, const MakeModel& make)
      : grid_(grid),
        make_(make),
        map_(std::make_shared<const BranchMap>(grid)),
        energies_(std::make_shared<const NodeEnergies>(grid, &map_->nodes,
                                                       record_fields(grid, make, 2))) {}

  /// @param at the hand's point, m. @param from where it comes from
  Held hold(const Hand& hand, const Vec3& from, const Vec3& at, double phase, double tremor,
            double seconds, const SafetyLimits& limits) const {
    const SimulatedOptions options{.stiffness = hand.stiffness, .delay = hand.delay};
    std::size_t begin = 0;
    SimulatedDevice device(options, [&](std::uint64_t, std::vector<Vec3>& targets) {
      begin = way(hand, from, at, phase, tremor, seconds, targets);
    });
    Mapping mapping({}, device.info(), grid_.box());
    BranchTraversal traversal(grid_, map_);
    std::optional<Beside> beside;
    if (hand.late) {
      beside.emplace(grid_, make_(), hand.late);
      beside->begin(kRate);
      traversal.walk_beside(&*beside);
    }
    SafetyCore safety(limits);
    struct Force {
      NodeForce force;
      double metres;
      Vec3 operator()(const Traversal& t) { return force(t); }
      double stored_energy(const Traversal& t) const { return force.energy(t) * metres; }
    } force{NodeForce(energies_, grid_.box(), hermite_force), limits.gain / mapping.scale()};
    Held held;
    const double ticks = seconds * kRate;
    double n = 0, weak = 0;
    bool is_full = false;
    std::atomic<int> stop{0};
    std::atomic<std::uint64_t> beat{0};
    run_loop(
        device, mapping, traversal, safety, force,
        [&](const Tick& tick) {
          const double t = static_cast<double>(tick.number) - static_cast<double>(begin);
          if (t < 0) return;
          const double raw = limits.gain * length_of(tick.raw_force);
          const double sent = length_of(tick.force.force);
          if (tick.step.snapped && t > 500) held.snapped = true;
          if (!(sent >= 0.95 * raw - 0.01)) weak = t;
          if (!is_full) held.full = weak / kRate;
          if (t - weak > kRate / 4) is_full = true;
          if (t > ticks * 2 / 3) {
            held.low = std::min(held.low, sent);
            held.high = std::max(held.high, sent);
          }
          if (t > ticks * 0.9) held.raw += raw, held.sent += sent, ++n;
        },
        stop, beat);
    held.raw /= n, held.sent /= n;
    return held;
  }

 private:
  /// @return the tick in which the hold begins
  static std::size_t way(const Hand& hand, const Vec3& from, const Vec3& at, double phase,
                         double tremor, double seconds, std::vector<Vec3>& targets) {
    targets.clear();
    if (hand.approaches) {
      const double leg = length_of(at - from) / 0.1 * kRate;
      for (double i = 0; i < leg; ++i) {
        const double t = i / leg;
        targets.push_back(from + t * t * t * (10 - 15 * t + 6 * t * t) * (at - from));
      }
    }
    const std::size_t begin = targets.size();
    targets.resize(begin + static_cast<std::size_t>(seconds * kRate), at);
    for (std::size_t i = 0; i < targets.size(); ++i)
      for (int a = 0; a < 3; ++a) {
        const double hertz = 8 + std::fmod(phase * (a + 1), 1.0) * 4;
        targets[i][a] +=
            tremor * std::sin(2 * std::numbers::pi * hertz * static_cast<double>(i) / kRate);
      }
    return begin;
  }

  const Grid& grid_;
  MakeModel make_;
  std::shared_ptr<const BranchMap> map_;
  std::shared_ptr<const NodeEnergies> energies_;
};

void measure(const Grid& grid, const Player& player, const Hand& hand, int contacts,
             std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto somewhere = [&] {
    const Box& box = grid.box();
    int longest = 0;
    for (int a = 1; a < 3; ++a)
      if (box.counts[a] > box.counts[longest]) longest = a;
    Vec3 x;
    for (int a = 0; a < 3; ++a)
      x[a] = kReach / 2 * uniform(random, -1, 1) * (box.counts[a] - 1) / (box.counts[longest] - 1);
    return x;
  };
  constexpr double kInf = std::numeric_limits<double>::infinity();
  SafetyLimits with, without{.max_speed = kInf, .buzz_force = kInf, .reserve = kInf};
  with.gain = without.gain = hand.gain;
  int tried = 0, found = 0, weak = 0, swinging = 0, unstable = 0;
  double least = 1, most = 0, longest = 0;
  for (; found < contacts && tried < 400; ++tried) {
    const Vec3 from = somewhere(), at = somewhere();
    const double phase = uniform(random, 0, 1);
    const Held rest = player.hold(hand, from, at, phase, 0, 3, without);
    if (rest.sent < 0.1 || rest.sent > 2.5) continue;
    const Held open = player.hold(hand, from, at, phase, hand.tremor, hand.seconds, without);
    if (open.sent < 0.999 * open.raw) continue;  // outside the box the force fades
    if (rest.swing() > 0.02 || open.snapped) {
      ++unstable;
      continue;
    }
    const Held held = player.hold(hand, from, at, phase, hand.tremor, hand.seconds, with);
    ++found;
    const double part = held.sent / held.raw, swings = held.swing() / std::max(open.swing(), 1e-3);
    weak += part < 0.95;
    least = std::min(least, part);
    swinging += held.swing() > 1.2 * open.swing() + 0.01;
    most = std::max(most, swings);
    longest = std::max(longest, held.full);
  }
  std::printf("%g\t%g\t%g\t%s\t%d\t%d\t%.3f\t%d\t%.2f\t%.2f\t(unstable %d)\n", hand.tremor * 1e3,
              hand.stiffness, hand.gain, hand.approaches ? "approach" : "contact", found, weak,
              least, swinging, most, longest, unstable);
  std::fflush(stdout);
}

std::vector<double> numbers(const char* text) {
  std::vector<double> all;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');)
    all.push_back(std::strtod(word.c_str(), nullptr));
  return all;
}

int run(const Grid& grid, int argc, char** argv) {
  const auto number = [&](int i, double other) {
    return argc > i ? std::strtod(argv[i], nullptr) : other;
  };
  const Player player(grid, model_of(grid, argv[2]));
  for (const double stiffness : numbers(argv[4]))
    for (const double gain : numbers(argv[5]))
      for (const double tremor : numbers(argv[3]))
        measure(
            grid, player,
            {tremor / 1e3, stiffness, gain, std::string(argv[6]) == "approach", number(8, 60),
             static_cast<std::uint32_t>(number(10, 0)),
             argc > 11 ? std::optional(static_cast<std::uint32_t>(number(11, 0))) : std::nullopt},
            static_cast<int>(number(7, 20)), static_cast<std::uint64_t>(number(9, 1)));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::main_of(
      argc, argv, 7,
      "bench_tremor GRID MODELS TREMOR STIFFNESS GAIN START [CONTACTS] [SECONDS] [SEED] [DELAY] "
      "[LATE]",
      run);
}
