// Whether an ordinary hand that moves feels the model's force: it strokes, kneads, taps, swings.
//
//   bench_motions GRID MODELS [CONTACTS] [SEED] [LATE] [STIFFNESS] [GAIN] [MOTION...]
//
// MODELS is the directory of the plug-ins. The hand, a spring of STIFFNESS (300 N/m) and a damper
// of 3 N s/m, holds a handle of 0.1 kg with an encoder of 5.5e-5 m and trembles by 0.1 mm. Forces
// come a tick later than declared. The grid is alone, or the model walks beside it and its answers
// are LATE ticks late (-: alone). A contact is a random place of the box in which the hand comes to
// rest with 0.2 to 2 N. Each MOTION (all) is done at each of CONTACTS (20) of them.
//
// A line: the motion; ticks in contact (more than 0.05 N, after the ramp, not slewed, not clamped);
// the part of them, in %, with less than 80 % of the force before the core, along that force; the
// energy that came back beyond what the ramp granted, at worst, in mJ.
#include <cstdlib>

#include "tests/bench/hand.hpp"

namespace {

using namespace hapgrid;
using namespace hapgrid::bench;

/// Of one motion, over all contacts.
struct Figures {
  int ticks = 0, weak = 0;
  double returned = 0;

  void add(const Tick& tick, const SimulatedDevice& device, const SafetyCore& safety, double gain) {
    const Vec3 raw = gain * tick.raw_force;
    returned = std::max(returned, 1e3 * (device.work() - safety.granted()));
    if (tick.force.acted & (kRamped | kSlewed | kClamped | kFaded) || length_of(raw) <= 0.05)
      return;
    ++ticks;
    weak += dot(tick.force.force, raw) < 0.8 * dot(raw, raw);
  }
};

struct Contact {
  Vec3 at;   // m, of the hand's point
  Vec3 out;  // unit vector along the force
  double phase;
};

using Targets = std::vector<Vec3>;
/// @param next another contact
using Motion = void (*)(Targets& to, const Contact& here, const Contact& next);

/// To the contact from 25 mm outside of it.
void approach(Targets& to, const Contact& here) {
  to.push_back(here.at + 0.025 * here.out);
  rest(to, 0.7);
  move_to(to, here.at, 0.05);
  rest(to, 0.5);
}

void knead(Targets& to, const Contact& here, double size, double hertz) {
  approach(to, here);
  for (int i = 0; i < 4 * kRate; ++i)
    to.push_back(here.at - size * std::sin(2 * std::numbers::pi * hertz * i / kRate) * here.out);
}

void tap(Targets& to, const Contact& here, double speed) {
  to.push_back(here.at + 0.015 * here.out);
  rest(to, 0.7);
  for (int i = 0; i < 8; ++i) {
    move_to(to, here.at - 0.002 * here.out, speed);
    rest(to, 0.1);
    move_to(to, to.front(), speed);
    rest(to, 0.15);
  }
}

/// To and fro through the contact.
void through(Targets& to, const Contact& here, double speed, int times) {
  to.push_back(here.at + 0.025 * here.out);
  rest(to, 0.7);
  for (int i = 0; i < times; ++i) {
    move_to(to, here.at - 0.025 * here.out, speed);
    rest(to, 0.2);
    move_to(to, to.front(), speed);
    rest(to, 0.2);
  }
}

constexpr std::pair<const char*, Motion> kMotions[] = {
    {"stroke",
     [](Targets& to, const Contact& here, const Contact& next) {
       approach(to, here);
       for (int i = 0; i < 3; ++i) move_to(to, next.at, 0.05), move_to(to, here.at, 0.05);
     }},
    {"hold",
     [](Targets& to, const Contact& here, const Contact&) { approach(to, here), rest(to, 6); }},
    {"knead 4 mm",
     [](Targets& to, const Contact& here, const Contact&) { knead(to, here, 0.004, 2); }},
    {"knead 10 mm",
     [](Targets& to, const Contact& here, const Contact&) { knead(to, here, 0.010, 2.5); }},
    {"barrier",
     [](Targets& to, const Contact& here, const Contact&) { through(to, here, 0.05, 2); }},
    {"contacts",
     [](Targets& to, const Contact& here, const Contact& next) {
       approach(to, here), rest(to, 2);
       for (int i = 0; i < 2; ++i) {
         move_to(to, next.at, 0.1), rest(to, 2.5);
         move_to(to, here.at, 0.1), rest(to, 2.5);
       }
     }},
    {"tap 0.08 m/s", [](Targets& to, const Contact& here, const Contact&) { tap(to, here, 0.08); }},
    {"tap 0.2 m/s", [](Targets& to, const Contact& here, const Contact&) { tap(to, here, 0.2); }},
    {"swing 0.5 m/s",
     [](Targets& to, const Contact& here, const Contact&) { through(to, here, 0.5, 6); }},
};

std::vector<Contact> find_contacts(const Grid& grid, const Player& player,
                                   const SimulatedOptions& hand, const SafetyLimits& limits,
                                   std::size_t wanted, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Contact> found;
  for (int tried = 0; found.size() < wanted && tried < 1000; ++tried) {
    const Vec3 from = somewhere(grid.box(), random), at = somewhere(grid.box(), random);
    const double phase = uniform(random, 0, 1);
    Targets to{from};
    rest(to, 0.6), move_to(to, at, 0.1), rest(to, 1);
    Vec3 sent{0, 0, 0};
    bool fades = false;
    player.play(hand, to, limits, {},
                [&](const Tick& tick, const SimulatedDevice&, const SafetyCore&) {
                  sent = tick.force.force;
                  fades = fades || tick.force.acted & kFaded;
                });
    const double size = length_of(sent);
    if (size > 0.2 && size < 2 && !fades) found.push_back({at, 1 / size * sent, phase});
  }
  return found;
}

int run(const Grid& grid, int argc, char** argv) {
  const auto number = [&](int i, double other) {
    return argc > i ? std::strtod(argv[i], nullptr) : other;
  };
  const Player player(grid, model_of(grid, argv[2]));
  SafetyLimits limits;
  limits.gain = number(7, 1);
  const SimulatedOptions hand{.stiffness = number(6, 300), .hand_damping = 3, .delay = 1};
  std::optional<std::uint32_t> late;
  if (argc > 5 && std::string(argv[5]) != "-") late = static_cast<std::uint32_t>(number(5, 0));
  const std::vector<Contact> contacts =
      find_contacts(grid, player, hand, limits, static_cast<std::size_t>(number(3, 20)),
                    static_cast<std::uint64_t>(number(4, 1)));
  for (const auto& [name, motion] : kMotions) {
    if (argc > 8 && std::find(argv + 8, argv + argc, std::string(name)) == argv + argc) continue;
    Figures figures;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      Targets to;
      motion(to, contacts[i], contacts[(i + 1) % contacts.size()]);
      tremble(to, 1e-4, contacts[i].phase);
      player.play(hand, to, limits, late,
                  [&](const Tick& tick, const SimulatedDevice& device, const SafetyCore& safety) {
                    figures.add(tick, device, safety, limits.gain);
                  });
    }
    std::printf("%s\t%d\t%.2f\t%.3f\n", name, figures.ticks,
                100.0 * figures.weak / std::max(figures.ticks, 1), figures.returned);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return bench::main_of(
      argc, argv, 3,
      "bench_motions GRID MODELS [CONTACTS] [SEED] [LATE] [STIFFNESS] [GAIN] [MOTION...]", run);
}
