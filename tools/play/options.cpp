#include "tools/play/options.hpp"

#include <CLI/CLI.hpp>
#include <map>
#include <sstream>

#include "tools/common/tool.hpp"

namespace hapgrid {

namespace {

/// Reads "x,-z,y": the device's axis, with a sign, that each axis of the box follows.
std::optional<std::array<Vec3, 3>> read_axes(const std::string& text) {
  std::istringstream words(text);
  std::string word;
  std::array<Vec3, 3> read{};
  int count = 0;
  std::string used;
  for (; std::getline(words, word, ','); ++count) {
    if (count == 3) return std::nullopt;
    const double sign = word[0] == '-' ? -1 : 1;
    if (word[0] == '-' || word[0] == '+') word.erase(0, 1);
    if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return std::nullopt;
    if (used.find(word) != std::string::npos) return std::nullopt;
    used += word;
    read[count][word[0] - 'x'] = sign;
  }
  if (count != 3) return std::nullopt;
  return read;
}

void add_device_options(CLI::App& app, PlayOptions& options) {
  app.add_option("grid", options.grid, "Complete grid ('-': standard input)")->type_name("GRID");
  app.add_option_function<std::string>(
         "--device", [&](const std::string& name) { options.device = parse_device(name); },
         "path:FILE, the positions in FILE ('path:-': standard input);\n"
         "keys, the keyboard of this terminal; replay:FILE, what a log has;\n"
         "sim:FILE, a simulated device and hand that a TOML describes;\n"
         "profile:FILE, a HID device that a text describes; pid[:WHICH],\n"
         "a joystick of HID's PID class; spacemouse[:WHICH], which steers")
      ->type_name("DEVICE");
  app.add_option_function<std::string>(
         "--traversal", [&](const std::string& name) { options.traversal = rule_named(name); },
         "How states follow the hand: paper, by Algorithm 2 (default);\n"
         "branch, with snaps where the model snaps; or model, by the\n"
         "model itself, which no live device can wait for")
      ->type_name("RULE")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return rule_named(name) ? std::string()
                                    : "'" + name + "' is not one of " + rule_names();
          },
          ""));
  app.add_flag("--list-devices", options.list_devices, "List the HID devices of this machine");
  app.add_option("--dump-descriptor", options.dump_descriptor,
                 "Print the report descriptor of a HID device. WHICH is a path,\n"
                 "VID:PID, VID:PID:SERIAL or serial number of --list-devices")
      ->type_name("WHICH");
  add_model_path(app, options.model_path);
  app.set_config("--config", "",
                 "Take options and settings from the table [play] of a TOML\n"
                 "file, such as the MODEL.toml; the command line counts more")
      ->type_name("FILE");
}

void add_time_options(CLI::App& app, PlayOptions& options) {
  app.add_option("--rate", options.rate_hz,
                 "Ticks a second (default: 1000 for a live device; a path or\n"
                 "replay plays as fast as possible, sim: always so, and its\n"
                 "virtual ticks are of this rate or 1000 Hz)")
      ->type_name("HZ")
      ->check(number_within(1e-3, 1e6, "a rate from 0.001 to 1000000 Hz"));
  app.add_option("--duration", options.duration_s,
                 "End after this time; of --selftest: the time for each rate\n"
                 "(default: when the device ends; 4 s)")
      ->type_name("S")
      ->check(number_within(0.001, 1e9, "a time from 0.001 to 1e9 s"));
  static const std::map<std::string, RealtimeMode> modes{{"require", RealtimeMode::kRequire},
                                                         {"try", RealtimeMode::kTry},
                                                         {"off", RealtimeMode::kOff}};
  app.add_option_function<std::string>(
         "--realtime", [&](const std::string& name) { options.realtime = modes.at(name); },
         "SCHED_FIFO and locked memory: require, try or off (default:\n"
         "try); play says at the start what it got")
      ->type_name("MODE")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return modes.contains(name) ? std::string()
                                        : "'" + name + "' is not require, try or off";
          },
          ""));
  app.add_flag("--selftest", options.selftest,
               "Grade this machine, without a device or grid: how late is a\n"
               "loop at 1, 2 and 5 kHz (or --rate)?");
}

void add_output_options(CLI::App& app, PlayOptions& options) {
  app.add_option("--log", options.log,
                 "Log of all ticks ('-': standard output). FILE.session is\n"
                 "compact and can be replayed; any other name gets a text")
      ->type_name("FILE");
  app.add_option("--frames", options.frames,
                 "Frames for view, 25 a second ('-': standard output, which is\n"
                 "the default for a live device and a pipe)")
      ->type_name("FILE");
  app.add_option("--report", options.report,
                 "JSON report of the play: ticks, lateness, computing time, what\n"
                 "the safety core did")
      ->type_name("FILE");
  app.add_option("--sessions", options.sessions,
                 "Table of the sessions of sim:, a line for each of them")
      ->type_name("FILE");
}

void add_force_options(CLI::App& app, PlayOptions& options) {
  app.add_option_function<std::string>(
         "--axes", [&](const std::string& text) { options.axes = read_axes(text); },
         "Device's axes (x to the right, y away from the user, z up) that\n"
         "the box's x, y and z follow: -z,x,y (default: x,y,z)")
      ->type_name("AXES")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return read_axes(text) ? std::string() : "'" + text + "' is not like -z,x,y";
          },
          ""));
  add_settings(app, options.given);
}

void add_imd_options(CLI::App& app, PlayOptions& options) {
  CLI::Option* const imd =
      app.add_option_function<std::uint16_t>(
             "--imd",
             [&](const std::uint16_t& port) { options.imd_port = options.imd.port = port; },
             "Serve viewers of molecules on this TCP port (usually 8888; 0:\n"
             "any), without a password: who reaches the port sees the play")
          ->type_name("PORT")
          ->check(number_within(0, 65535, "a port from 0 to 65535"));
  app.add_option("--imd-version", options.imd.version, "2 for VMD (default), 3 for MDAnalysis")
      ->type_name("2|3")
      ->check(CLI::IsMember({2, 3}))
      ->needs(imd);
  app.add_option("--imd-address", options.imd.address,
                 "Address to serve them on, in numbers (default: 127.0.0.1;\n"
                 "0.0.0.0: every network of this machine)")
      ->type_name("ADDR")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return ImdServer::is_address(text) ? std::string()
                                               : "'" + text + "' is not an address in numbers";
          },
          ""))
      ->needs(imd);
}

}  // namespace

void add_play_options(CLI::App& app, PlayOptions& options) {
  app.allow_config_extras(CLI::config_extras_mode::error);
  add_device_options(app, options);
  add_time_options(app, options);
  add_output_options(app, options);
  add_force_options(app, options);
  add_imd_options(app, options);
}

}  // namespace hapgrid
