// Plays a grid with simulated hands, in virtual time: the loop, rules and safety core of play. The
// same command gives the same bytes on every machine. simulated.hpp has the equation of the hand.
//
//   bench_hands GRID HAND.toml [OPTION...]
//
// All keys of HAND.toml may be left out. With a unit and the default:
//
//   mass, damping          kg 0.1, N s/m 0: of the device's handle
//   encoder                m, 5.5e-5: steps to which positions are rounded
//   delay                  ticks, 0: from when a force is sent until it is in effect
//   reach                  m, 0.1: side of the cube in which the handle moves; the longest side of
//                          the box is mapped to it
//   truth                  false; true: the model itself runs beside what is played, and the forces
//                          of both are compared
//   hand.stiffness, hand.damping   N/m 300, N s/m 1.5: of the hand
//   hand.tremor            m, 0: amplitude on each axis, by 8, 10 and 12 Hz; people's hands have
//                          0.05 to 0.3 mm
//   hand.next              s, never: the hand goes on to the next level whenever this time has
//                          passed
//   hand.path              none: a path in the box's unit, which the hand follows once
//   random.seed, random.sessions, random.seconds   1, 1000, 5 s: without a path the hand moves at
//                          random, in sessions of this length
//   random.speed, random.hold   m/s 0.1, s 1.5: mean speed of the fastest way, length of a rest
//
// A session begins at rest, at a place that the seed and the session's number decide. The hand goes
// to another place in the box, straight and with least jerk, then to the next one. Before each way
// it rests with a probability of one half. The columns of --sessions are explained in sessions.hpp.
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/json.hpp"
#include "libcore/loop/loop.hpp"
#include "tests/bench/sessions.hpp"
#include "tests/bench/simulation.hpp"
#include "tools/common/signals.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/beside.hpp"
#include "tools/play/log.hpp"
#include "tools/play/prepared.hpp"
#include "tools/play/settings.hpp"
#include "tools/play/viewers.hpp"

using namespace hapgrid;

namespace {

struct Options {
  std::string grid, hand, log, frames, report, sessions;
  TraversalRule rule = kDefaultRule;
  std::string beside = kBesideOn;
  double rate_hz = kUnpacedHz;
  ModelOptions model;
  GivenSettings given;
  PlayFile file;
};

void add_options(CommandLine& app, Options& options) {
  app.add("grid", options.grid, "Complete grid.").type("GRID");
  app.add("hand", options.hand, "TOML file of the hand and its device.").type("HAND");
  app.add(
         "--traversal", [&](const std::string& name) { options.rule = *rule_named(name); },
         "Rule, as play has it.")
      .type("RULE")
      .check([](const std::string& name) { return rule_named(name).has_value(); },
             "one of " + rule_names());
  app.add("--beside", options.beside, "The model beside the grid, as play has it.")
      .type("on|off|TICKS")
      .check(is_beside, "on, off or a number of ticks");
  app.add("--rate", options.rate_hz, "Ticks a second. Default: 1000.")
      .type("HZ")
      .within(1e-3, 1e6, "a rate");
  add_model_options(app, options.model);
  add_settings(app, options.given, options.file);
  app.add("--log", options.log, "Log of all ticks, as play has it.").type("FILE").writes();
  app.add("--frames", options.frames, "Frames for view.").type("FILE").writes();
  app.add("--report", options.report, "Figures of all sessions, in JSON.").type("FILE").writes();
  app.add("--sessions", options.sessions, "Table with a line for each session.")
      .type("FILE")
      .writes();
}

void write(const std::string& file, const std::string& text) {
  if (file.empty()) return;
  OutputFile output(file, /*binary=*/false);
  output.write(text);
  output.commit();
}

int play(const Options& options) {
  const PlayedGrid grid(options.grid, options.model);
  const Simulation simulation = read_simulation(options.hand, options.rate_hz);
  PlaySettings settings = changed(changed({}, options.file.given), options.given);
  const DeviceInfo info = SimulatedDevice::info(simulation.device);
  settings.safety.max_force = std::min(settings.safety.max_force, info.max_force);
  Mapping mapping(settings.mapping, info, grid.spec().box);
  const auto device = simulated_device(simulation, mapping, grid.spec().box);

  Follower follower(grid, options.rule, options.beside, /*must=*/!options.model.allowed.empty(),
                    /*live=*/false);
  const auto truth = simulation.truth
                         ? traversals(TraversalRule::kModel, grid.grid, grid.create_exact)()
                         : nullptr;
  SafetyCore safety(settings.safety);
  Sessions sessions(*device, safety, grid.fields,
                    {.rate_hz = options.rate_hz, .gain = settings.safety.gain}, truth.get());
  const CaughtSignals signals;
  Viewers viewers(options.frames, "");
  viewers.start(
      grid.spec(), grid.create, options.rate_hz, /*paced=*/false, caught_signal,
      std::min(settings.safety.max_force, settings.safety.gain * follower.force.largest()));
  PlayedForce force{follower.force, settings.safety.gain, mapping.scale()};
  Log log(options.log, grid, options.rate_hz, /*paced=*/false, ~std::size_t{0},
          {.limits = settings.safety,
           .scale = mapping.scale(),
           .traversal = options.rule,
           .beside = follower.beside ? options.beside : kBesideOff});
  if (follower.beside) follower.beside->begin(options.rate_hz);
  std::atomic<std::uint64_t> heartbeat{0};
  const LoopSummary summary = run_loop(*device, mapping, *follower.traversal, safety, force,
                                       [&](const Tick& tick) {
                                         log.add(tick);
                                         viewers.show(tick);
                                         sessions.add(tick);
                                       },
                                       caught_signal, heartbeat, {.unpaced_hz = options.rate_hz});
  log.finish();
  viewers.finish();
  sessions.finish();
  std::fputs(sessions_text(sessions).c_str(), stderr);
  write(options.sessions, sessions_table(sessions));
  nlohmann::ordered_json report = sessions_json(sessions);
  report["ticks"] = summary.ticks;
  if (!options.report.empty()) write(options.report, json_text(report));
  if (summary.count_of(kFault) > 0)
    throw Error(format("zero force in {} of {} ticks", summary.count_of(kFault), summary.ticks));
  return caught_signal ? 128 + caught_signal : kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CommandLine app("Plays a grid with simulated hands, in virtual time.");
  app.set_help("bench_hands", "Settings, keys of the table [play] of --config:\n" + settings_help(),
               "");
  add_options(app, options);
  return run_tool(app, argc, argv, [&] { return play(options); });
}
