#include "tools/play/options.hpp"

#include <charconv>
#include <map>

#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

std::optional<std::uint16_t> read_port(const std::string& text) {
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, port);
  return read.ec == std::errc() && read.ptr == end ? std::optional(port) : std::nullopt;
}

void add_device_options(CommandLine& app, PlayOptions& options) {
  app.add("grid", options.grid, "Complete grid ('-': standard input)").type("GRID");
  app.add(
         "--device", [&](const std::string& name) { options.device = parse_device(name); },
         "path:FILE, the positions in FILE ('path:-': standard input; live\n"
         "in a named pipe); keys, this terminal's keyboard; replay:FILE,\n"
         "what a log has; sim:FILE, device and hand simulated by a TOML;\n"
         "profile:FILE, a HID device that a text describes; evdev[:WHICH],\n"
         "a gamepad, stick or wheel; spacemouse[:WHICH], which steers;\n"
         "process:COMMAND, an adapter to a maker's kit (split at blanks)")
      .type("DEVICE");
  app.add(
         "--traversal", [&](const std::string& name) { options.traversal = rule_named(name); },
         "How states follow the hand: branch, with snaps where the model\n"
         "snaps (default); paper, by Algorithm 2; or model, by the\n"
         "model itself, which no live device can wait for")
      .type("RULE")
      .check([](const std::string& name) { return rule_named(name).has_value(); },
             "one of " + rule_names());
  app.add(
         "--force", [&](const std::string& name) { options.force = force_named(name); },
         "What is interpolated: energy (default with branch); records,\n"
         "their forces; or state (default with paper and model)")
      .type("RULE")
      .check([](const std::string& name) { return force_named(name).has_value(); },
             "one of energy, records, state");
  app.add_flag("--list-devices", options.list_devices,
               "List the HID devices and sticks of this machine: WHICH is a path,\n"
               "VID:PID, VID:PID:SERIAL or serial number of this list");
  add_model_path(app, options.model_path);
}

void add_time_options(CommandLine& app, PlayOptions& options) {
  app.add("--rate", options.rate_hz,
          "Ticks a second (default: 1000 live, or what an adapter takes; a\n"
          "path or replay plays as fast as possible, sim: always so, and\n"
          "its virtual ticks are of this rate or 1000 Hz)")
      .type("HZ")
      .within(1e-3, 1e6, "a rate from 0.001 to 1000000 Hz");
  app.add("--duration", options.duration_s,
          "End after this time; of --selftest: the time for each rate\n"
          "(default: when the device ends; 4 s)")
      .type("S")
      .within(0.001, 1e9, "a time from 0.001 to 1e9 s");
  static const std::map<std::string, RealtimeMode> modes{{"require", RealtimeMode::kRequire},
                                                         {"try", RealtimeMode::kTry},
                                                         {"off", RealtimeMode::kOff}};
  app.add(
         "--realtime", [&](const std::string& name) { options.realtime = modes.at(name); },
         "SCHED_FIFO and locked memory: require, try (default) or off")
      .type("MODE")
      .check([](const std::string& name) { return modes.contains(name); }, "require, try or off");
  app.add_flag("--selftest", options.selftest,
               "Grade this machine, without a device or grid: how late is a\n"
               "loop at 1, 2 and 5 kHz (or --rate)?");
}

void add_output_options(CommandLine& app, PlayOptions& options) {
  app.add("--log", options.log,
          "Log of all ticks ('-': standard output). FILE.session is\n"
          "compact and can be replayed; any other name gets a text")
      .type("FILE");
  app.add("--frames", options.frames,
          "Frames for view, 25 a second ('-': standard output, which is\n"
          "the default for a live device and a pipe)")
      .type("FILE");
  app.add("--report", options.report,
          "JSON report: ticks, lateness, computing time, what safety did")
      .type("FILE");
  app.add("--sessions", options.sessions, "Table of the sessions of sim:, a line for each of them")
      .type("FILE");
}

void add_force_options(CommandLine& app, PlayOptions& options) {
  app.add(
         "--axes", [&](const std::string& text) { options.axes = read_axes(text); },
         "Device's axes (x to the right, y away from the user, z up) that\n"
         "the box's x, y and z follow: -z,x,y (default: x,y,z)")
      .type("AXES")
      .check([](const std::string& text) { return read_axes(text).has_value(); }, "like -z,x,y");
  add_settings(app, options.given, options.file);
}

void add_imd_options(CommandLine& app, PlayOptions& options) {
  const Option imd = app.add(
                            "--imd",
                            [&](const std::string& text) {
                              options.imd_port = options.imd.port = *read_port(text);
                            },
                            "Serve viewers of molecules on this TCP port (usually 8888; 0:\n"
                            "any), without a password: who reaches the port sees the play")
                         .type("PORT")
                         .check([](const std::string& text) { return read_port(text).has_value(); },
                                "a port from 0 to 65535");
  app.add("--imd-version", options.imd.version, "2 for VMD (default), 3 for MDAnalysis")
      .type("2|3")
      .one_of({"2", "3"})
      .needs(imd);
  app.add("--imd-address", options.imd.address,
          "Address to serve them on, in numbers (default: 127.0.0.1;\n"
          "0.0.0.0: every network of this machine)")
      .type("ADDR")
      .check(ImdServer::is_address, "an address in numbers")
      .needs(imd);
}

}  // namespace

void add_play_options(CommandLine& app, PlayOptions& options) {
  add_device_options(app, options);
  add_time_options(app, options);
  add_output_options(app, options);
  add_force_options(app, options);
  add_imd_options(app, options);
}

}  // namespace hapgrid
