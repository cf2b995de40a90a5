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
// force before the core, at the end; the lowest such part.
#include <cstdlib>
#include <sstream>

#include "tests/bench/hand.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

/// What a hand feels in a hold.
struct Held {
  double raw = 0, sent = 0;           // mean magnitude in the last tenth of the hold, N
  double low = 1e300, high = -1e300;  // of the magnitude that was sent, in the last third
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

/// @param at the hand's point, m. @param from where it comes from
Held hold(const Player& player, const Hand& hand, const Vec3& from, const Vec3& at, double phase,
          double tremor, double seconds, const SafetyLimits& limits) {
  std::vector<Vec3> targets{at};
  if (hand.approaches) {
    targets = {from};
    move_to(targets, at, 0.1);
  }
  const double begin = static_cast<double>(targets.size() - 1), ticks = seconds * kRate;
  rest(targets, seconds);
  tremble(targets, tremor, phase);
  Held held;
  double n = 0;
  player.play({.stiffness = hand.stiffness, .delay = hand.delay}, targets, limits, hand.late,
              [&](const Tick& tick, const SimulatedDevice&, const SafetyCore&) {
                const double t = static_cast<double>(tick.number) - begin;
                if (t < 0) return;
                const double raw = limits.gain * length_of(tick.raw_force);
                const double sent = length_of(tick.force.force);
                if (tick.step.snapped && t > 500) held.snapped = true;
                if (t > ticks * 2 / 3) {
                  held.low = std::min(held.low, sent);
                  held.high = std::max(held.high, sent);
                }
                if (t > ticks * 0.9) held.raw += raw, held.sent += sent, ++n;
              });
  held.raw /= n, held.sent /= n;
  return held;
}

void measure(const Grid& grid, const Player& player, const Hand& hand, int contacts,
             std::uint64_t seed) {
  std::mt19937_64 random(seed);
  constexpr double kInf = std::numeric_limits<double>::infinity();
  SafetyLimits with, without{.max_speed = kInf, .buzz_force = kInf, .reserve = kInf};
  with.gain = without.gain = hand.gain;
  int tried = 0, found = 0, weak = 0, unstable = 0;
  double least = 1;
  for (; found < contacts && tried < 400; ++tried) {
    const Vec3 from = somewhere(grid.box(), random), at = somewhere(grid.box(), random);
    const double phase = uniform(random, 0, 1);
    const Held rest = hold(player, hand, from, at, phase, 0, 3, without);
    if (rest.sent < 0.1 || rest.sent > 2.5) continue;
    const Held open = hold(player, hand, from, at, phase, hand.tremor, hand.seconds, without);
    if (open.sent < 0.999 * open.raw) continue;  // outside the box the force fades
    if (rest.swing() > 0.02 || open.snapped) {
      ++unstable;
      continue;
    }
    const Held held = hold(player, hand, from, at, phase, hand.tremor, hand.seconds, with);
    ++found;
    const double part = held.sent / held.raw;
    weak += part < 0.95;
    least = std::min(least, part);
  }
  std::printf("%g\t%g\t%g\t%s\t%d\t%d\t%.3f\t(unstable %d)\n", hand.tremor * 1e3, hand.stiffness,
              hand.gain, hand.approaches ? "approach" : "contact", found, weak, least, unstable);
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
