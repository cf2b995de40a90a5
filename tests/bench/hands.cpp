// Plays a grid with simulated hands, in virtual time: the loop, rules and safety core of play.
// README.md explains the file of the hand and the figures.
//
//   bench_hands GRID HAND.toml [OPTION...]
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
  add_asked_model_options(app, options.model);
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
                         ? traversals(TraversalRule::kModel, grid.loaded.grid, grid.create_exact)()
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
  Log log(options.log, grid.loaded, grid.fields, options.rate_hz, /*paced=*/false, ~std::size_t{0},
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
