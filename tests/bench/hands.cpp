// Plays a grid with simulated hands, in virtual time: the loop, rules and safety core of play. The
// same command gives the same bytes on every machine. simulated.hpp has the equation of the hand.
//
//   bench_hands GRID [OPTION...]        (--help)
//
// A session begins at rest, at a place that the seed and the session's number decide. The hand goes
// to another place in the box, straight and with least jerk, then to the next one. Before each way
// it rests with a probability of one half. With --path it follows that path once. The longest side
// of the box is mapped to 0.1 m.
//
// --table has a line for each session, in mJ: what the model held where the ramp rose; what the
// device gave to the hand until the end; the most that it gave at any time beyond what was stored.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/path.hpp"
#include "libcore/loop/loop.hpp"
#include "tests/bench/simulated.hpp"
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
  std::string grid, path, log, frames, table;
  TraversalRule rule = kDefaultRule;
  std::string beside = kBesideOn;
  SimulatedOptions device{.sessions = 1000};
  WanderingOptions hand;
  ModelOptions model;
  GivenSettings given;
  PlayFile file;
};

void add_options(CommandLine& app, Options& options) {
  app.add("grid", options.grid, "Complete grid.").type("GRID");
  app.add(
         "--traversal", [&](const std::string& name) { options.rule = *rule_named(name); },
         "Rule, as play has it.")
      .type("RULE")
      .check([](const std::string& name) { return rule_named(name).has_value(); },
             std::string("one of ") + kRuleNames);
  app.add("--beside", options.beside, "The model beside the grid, as play has it.")
      .type("on|off|TICKS")
      .check(is_beside, "on, off or a number of ticks");
  const auto number = [&](const char* name, double& value, const char* unit, double low,
                          double high, const char* help) {
    app.add(name, value, help)
        .type(unit)
        .within(low, high, format("a number from {} to {}", low, high))
        .shows_default();
  };
  number("--rate", options.device.rate_hz, "HZ", 1e-3, 1e6, "Ticks a second.");
  number("--stiffness", options.device.stiffness, "N/M", 0, 1e6, "Of the hand.");
  number("--damping", options.device.hand_damping, "NS/M", 0, 1e4, "Of the hand.");
  number("--encoder", options.device.encoder, "M", 0, 0.1, "Positions are rounded to such steps.");
  app.add("--delay", options.device.delay, "Ticks from when a force is sent until it is in effect.")
      .type("N")
      .whole(0, 10000);
  app.add("--path", options.path, "A path in the box's unit, in place of ways at random.")
      .type("FILE");
  app.add("--seed", options.hand.seed, "Of the ways.").type("N");
  app.add("--sessions", options.device.sessions, "How many.").type("N").whole(1, 1'000'000);
  number("--seconds", options.hand.seconds, "S", 1e-3, 1e4, "Length of a session.");
  number("--speed", options.hand.speed, "M/S", 1e-6, 1e3, "Mean speed of the fastest way.");
  number("--hold", options.hand.hold, "S", 0, 1e6, "Length of a rest.");
  add_model_options(app, options.model);
  add_settings(app, options.given, options.file);
  app.add("--log", options.log, "Log of all ticks, as play has it.").type("FILE").writes();
  app.add("--frames", options.frames, "Frames for view.").type("FILE").writes();
  app.add("--table", options.table, "A line for each session.").type("FILE").writes();
}

SimulatedDevice::Targets targets(const Options& options, const Mapping& mapping, const Box& box) {
  if (options.path.empty()) {
    const Vec3 one = mapping.handle(box.origin), other = mapping.handle(box.high());
    Vec3 low, high;  // axes can be mirrored
    for (int a = 0; a < 3; ++a) std::tie(low[a], high[a]) = std::minmax(one[a], other[a]);
    return [low, high, hand = options.hand](std::uint64_t session, std::vector<Vec3>& places) {
      wander(hand, low, high, session, places);
    };
  }
  std::vector<Vec3> path;
  for (const DeviceInput& tick : parse_path(read_regular_text(options.path, 1 << 30), options.path))
    path.push_back(mapping.handle(tick.position));
  return [path](std::uint64_t, std::vector<Vec3>& places) { places = path; };
}

/// The energies of one session, in mJ; exact, of the force as it was in effect.
struct Session {
  double stored = 0, given = 0, returned = 0;
};

void write(const std::vector<Session>& sessions, const std::string& table) {
  std::string text = "# session\tstored_mJ\tgiven_mJ\treturned_mJ\n";
  double sum = 0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    const Session& s = sessions[i];
    text += format("{}\t{}\t{}\t{}\n", i, to_text(s.stored), to_text(s.given), to_text(s.returned));
    sum += s.returned;
    if (s.returned > sessions[worst].returned) worst = i;
  }
  if (!table.empty()) {
    OutputFile output(table, /*binary=*/false);
    output.write(text);
    output.commit();
  }
  if (sessions.empty()) return;
  std::fputs(
      format("hands: energy returned beyond what was stored, of {} sessions: mean {:.3g} mJ, "
             "worst {:.3g} mJ in session {}\n",
             sessions.size(), sum / static_cast<double>(sessions.size()), sessions[worst].returned,
             worst)
          .c_str(),
      stderr);
}

int play(Options& options) {
  const PlayedGrid grid(options.grid, options.model);
  const double rate = options.hand.rate_hz = options.device.rate_hz;
  if (!options.path.empty()) options.device.sessions = 1;
  PlaySettings settings = changed(changed({}, options.file.given), options.given);
  const DeviceInfo info = SimulatedDevice::info(options.device);
  settings.safety.max_force = std::min(settings.safety.max_force, info.max_force);
  Mapping mapping(settings.mapping, info, grid.spec().box);
  SimulatedDevice device(options.device, targets(options, mapping, grid.spec().box));

  Follower follower(grid, options.rule, options.beside, /*must=*/!options.model.allowed.empty(),
                    /*live=*/false);
  SafetyCore safety(settings.safety);
  const CaughtSignals signals;
  Viewers viewers(
      options.frames, "", grid.spec(), grid.create, rate, /*paced=*/false, caught_signal,
      std::min(settings.safety.max_force, settings.safety.gain * follower.force.largest()));
  follower.force.set_device(settings.safety.gain, mapping.scale());
  Log log(options.log, grid, rate, /*paced=*/false, ~std::size_t{0},
          {.limits = settings.safety,
           .scale = mapping.scale(),
           .traversal = options.rule,
           .beside = follower.beside ? options.beside : kBesideOff});
  if (follower.beside) follower.beside->begin(rate);
  std::vector<Session> sessions;
  std::atomic<std::uint64_t> heartbeat{0};
  const auto sink = [&](const Tick& tick) {
    log.add(tick);
    viewers.show(tick);
    if (tick.input.begins) sessions.emplace_back();
    Session& now = sessions.back();
    now.stored = 1e3 * safety.granted();
    now.given = 1e3 * device.work();
    now.returned = std::max(now.returned, now.given - now.stored);
  };
  const LoopSummary summary = run_loop(device, mapping, *follower.traversal, safety, follower.force,
                                       sink, caught_signal, heartbeat, {.unpaced_hz = rate});
  log.finish();
  viewers.finish();
  write(sessions, options.table);
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
