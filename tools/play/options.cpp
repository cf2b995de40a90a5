#include "tools/play/options.hpp"

#include <map>

#include "tools/common/tool.hpp"
#include "tools/play/beside.hpp"

namespace hapgrid {

namespace {

void add_device_options(CommandLine& app, PlayOptions& options) {
  app.add("grid", options.grid,
          "Complete grid to play ('-': standard input). Without it, an adapter's device is brought "
          "up.")
      .type("GRID");
  app.add(
         "--device",
         [&](const std::string& name) {
           options.device = parse_device(name);
           options.device_text = name;
         },
         "Device that moves the hand; the list below has all.")
      .type("DEVICE");
  app.add(
         "--traversal", [&](const std::string& name) { options.traversal = rule_named(name); },
         "Rule for the states: 'branch' snaps where the model snaps, 'paper' is Algorithm 2, and "
         "'model' waits for the model in each tick. Default: branch.")
      .type("RULE")
      .check([](const std::string& name) { return rule_named(name).has_value(); },
             std::string("one of ") + kRuleNames);
  app.add(
         "--beside", [&](const std::string& text) { options.beside = text; },
         "Whether the model corrects the grid's state and force: 'on', which never makes a live "
         "device wait; 'off'; or, for other devices, by how many TICKS it is late. Default: on, if "
         "it is a plug-in or allowed.")
      .type("on|off|TICKS")
      .check(is_beside, "on, off or a whole number of ticks from 1 to 10000");
  app.add_flag("--list-devices", options.list_devices,
               "List the devices of this machine, with the text for --device, instead of playing.")
      .goes_with({});
  add_model_options(app, options.model);
}

void add_time_options(CommandLine& app, PlayOptions& options) {
  app.add("--rate", options.rate_hz,
          "Rate of the control loop in Hz. Default: 1000 for a live device, or the rate that an "
          "adapter asks for. A path or replay runs as fast as possible unless a rate is given.")
      .type("HZ")
      .within(1e-3, 1e6, "a rate from 0.001 to 1000000 Hz");
  app.add("--duration", options.duration_s,
          "Time of play in seconds (default: until the device ends), or of each rate of --selftest "
          "(default: 4).")
      .type("S")
      .within(0.001, 1e9, "a time from 0.001 to 1e9 s");
  static const std::map<std::string, RealtimeMode> modes{{"require", RealtimeMode::kRequire},
                                                         {"try", RealtimeMode::kTry},
                                                         {"off", RealtimeMode::kOff}};
  app.add(
         "--realtime", [&](const std::string& name) { options.realtime = modes.at(name); },
         "Whether the loop needs SCHED_FIFO and locked memory, tries to get them, or does without. "
         "Default: try.")
      .type("require|try|off")
      .check([](const std::string& name) { return modes.contains(name); }, "require, try or off");
  app.add_flag(
         "--selftest", options.selftest,
         "Measure how late a loop is on this machine at 1, 2 and 5 kHz, or at --rate, without a "
         "device or grid.")
      .goes_with({"--rate", "--duration", "--realtime", "--config"});
}

void add_output_options(CommandLine& app, PlayOptions& options) {
  app.add("--log", options.log,
          "Log of all ticks ('-': standard output). FILE.session is compact and can be replayed; "
          "any other name gets a text, which a live device cannot write.")
      .type("FILE")
      .writes();
  app.add("--frames", options.frames,
          "Frames for view, 25 for each second of play, or 60 in real time ('-': standard output).")
      .type("FILE")
      .writes();
  app.add("--report", options.report,
          "Report in JSON: ticks, lateness, computing time, and what the safety core did ('-': "
          "standard output).")
      .type("FILE")
      .writes();
}

}  // namespace

void add_play_options(CommandLine& app, PlayOptions& options) {
  add_device_options(app, options);
  add_time_options(app, options);
  add_output_options(app, options);
  add_settings(app, options.given, options.file);
  app.option("--realtime").needs_one_of({"grid", "--selftest"});
  // Without a grid a device is brought up, or only looked at.
  for (const char* const of_play : {"--traversal", "--beside", "--allow-process", "--log",
                                    "--frames", "--report", "--gain", "--max-force", "--scale"})
    app.option(of_play).needs(app.option("grid"));
}

}  // namespace hapgrid
