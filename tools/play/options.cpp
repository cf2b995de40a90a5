#include "tools/play/options.hpp"

#include <CLI/CLI.hpp>
#include <limits>
#include <map>
#include <sstream>

#include "tools/common/tool.hpp"
#include "tools/play/devices.hpp"
#include "tools/play/table.hpp"

namespace hapgrid {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// "x,-z,y": what each of the box's axes follows.
bool read_axes(const std::string& text, std::array<Vec3, 3>& axes) {
  std::istringstream words(text);
  std::string word;
  std::array<Vec3, 3> read{};
  int count = 0;
  std::string used;
  for (; std::getline(words, word, ','); ++count) {
    if (count == 3) return false;
    const double sign = word[0] == '-' ? -1 : 1;
    if (word[0] == '-' || word[0] == '+') word.erase(0, 1);
    if (word.size() != 1 || word[0] < 'x' || word[0] > 'z') return false;
    if (used.find(word) != std::string::npos) return false;
    used += word;
    read[count][word[0] - 'x'] = sign;
  }
  if (count != 3) return false;
  axes = read;
  return true;
}

CLI::Option* add_number(CLI::App& app, const std::string& name, double& value,
                        const std::string& unit, const std::string& help, double low, double high,
                        const std::string& what) {
  return app.add_option(name, value, help)
      ->type_name(unit)
      ->check(number_within(low, high, what))
      ->capture_default_str();
}

struct SafetyOption {
  const char* name;
  double SafetyLimits::*value;
  const char* unit;
  const char* help;
  double high;
  const char* what;
};

constexpr SafetyOption kSafetyOptions[] = {
    {"--gain", &SafetyLimits::gain, "FACTOR", "Newtons felt for a newton of the model", 1e12,
     "a factor from 0 to 1e12"},
    {"--max-force", &SafetyLimits::max_force, "N",
     "Largest magnitude of the force; a larger one is scaled down. The device's own limit counts "
     "if it is smaller",
     1e6, "a force from 0 to 1000000 N"},
    {"--slew", &SafetyLimits::slew, "N/MS", "Largest change of the force in a millisecond", kInf,
     "a change from 0 N/ms"},
    {"--blend", &SafetyLimits::blend_ms, "MS",
     "A switch of levels changes the force over this time", 1e6, "a time from 0 to 1000000 ms"},
    {"--ramp", &SafetyLimits::ramp_ms, "MS",
     "The force comes in over this time, at the start and after a fault", 1e6,
     "a time from 0 to 1000000 ms"},
    {"--max-speed", &SafetyLimits::max_speed, "M/S",
     "A faster hand is let go; needs a known --scale", kInf, "a speed from 0 m/s"},
    {"--buzz-force", &SafetyLimits::buzz_force, "N",
     "A swing of the force this large counts as one", kInf, "a force from 0 N"},
    {"--buzz-rate", &SafetyLimits::buzz_rate, "PER_S",
     "Swings a second from which on the force is damped; at twice as many it is taken away", kInf,
     "a rate from 0 a second"},
    {"--fade", &SafetyLimits::fade_cells, "CELLS",
     "Outside the box the force fades to zero over so many spacings of the grid; 0: not at all",
     kInf, "a length from 0 cells"},
    {"--watchdog", &SafetyLimits::watchdog_ticks, "TICKS",
     "So many missed ticks give zero force, and a ramp", kInf, "a count from 0 ticks"},
};

void add_safety_options(CLI::App& app, SafetyLimits& limits) {
  for (const SafetyOption& o : kSafetyOptions)
    add_number(app, o.name, limits.*o.value, o.unit, o.help, 0, o.high, o.what)
        ->group("Safety (every force passes it; 'inf' switches a limit off)");
}

void add_pid_options(CLI::App& app, PidParameters& pid) {
  const std::string group = "Joysticks of the PID class, which do not say these";
  add_number(app, "--pid-newtons", pid.newtons, "N", "What the device gives at most on each axis",
             1e-6, 1e6, "a force from 1e-6 to 1000000 N")
      ->group(group);
  add_number(app, "--pid-range", pid.half_range, "M",
             "How far each axis goes from the middle to its end", 1e-6, 1e3,
             "a length from 1e-6 to 1000 m")
      ->group(group);
  app.add_option_function<std::vector<double>>(
         "--pid-signs",
         [&pid](const std::vector<double>& v) {
           pid.signs = {v[0], v[1]};
         },
         "Which sign of a force pushes to the right, and which towards the user, 1 or -1 each "
         "(default: -1,1)")
      ->type_name("X,Y")
      ->expected(2)
      ->delimiter(',')
      ->check(CLI::IsMember({1, -1}))
      ->group(group);
}

void add_mapping_options(CLI::App& app, PlayOptions& options) {
  const std::string group = "From the device to the box, and back";
  MappingOptions& m = options.mapping;
  add_number(app, "--scale", m.scale, "UNITS/M",
             "Model's units of length for a metre of the hand; 0: the device's reach fills the box",
             0, 1e15, "a scale from 0 to 1e15")
      ->group(group);
  app.add_option_function<std::string>(
         "--axes", [&m](const std::string& text) { read_axes(text, m.axes); },
         "Which axes of the device (x to the right, y away from the user, z up) the box's x, y and "
         "z follow, each with a sign: -z,x,y (default: x,y,z)")
      ->type_name("AXES")
      ->check(CLI::Validator(
          [](const std::string& text) {
            std::array<Vec3, 3> axes;
            return read_axes(text, axes) ? std::string() : "'" + text + "' is not like -z,x,y";
          },
          ""))
      ->group(group);
  app.add_option_function<std::vector<double>>(
         "--offset",
         [&m](const std::vector<double>& v) {
           m.offset = {v[0], v[1], v[2]};
         },
         "Where the middle of the device's reach is, from the middle of the box, in model's units "
         "(default: 0,0,0)")
      ->type_name("X,Y,Z")
      ->expected(3)
      ->delimiter(',')
      ->group(group);
  add_number(app, "--speed", m.speed, "UNITS/S",
             "Of a HIP that is steered (spacemouse), at full deflection; 0: the longest side of "
             "the box in 4 s",
             0, 1e15, "a speed from 0 to 1e15")
      ->group(group);
  add_number(app, "--key-step", options.key_step, "UNITS",
             "How far a key moves the HIP (keys); 0: half the grid's spacing", 0, 1e15,
             "a length from 0 to 1e15")
      ->group(group);
  app.add_option("--key-start", options.key_start,
                 "Where the HIP begins (keys), in model's units (default: the middle of the box)")
      ->type_name("X,Y,Z")
      ->expected(3)
      ->delimiter(',')
      ->group(group);
}

void add_imd_options(CLI::App& app, PlayOptions& options) {
  const std::string group = "Viewers of molecules (IMD)";
  CLI::Option* const imd =
      app.add_option_function<std::uint16_t>(
             "--imd",
             [&](const std::uint16_t& port) { options.imd_port = options.imd.port = port; },
             "TCP port to serve viewers of molecules on (usually 8888; 0: the system chooses). "
             "There is no authentication and no encryption: whoever reaches the port sees the play")
          ->type_name("PORT")
          ->check(number_within(0, 65535, "a port from 0 to 65535"))
          ->group(group);
  app.add_option("--imd-version", options.imd.version, "2 for VMD, 3 for MDAnalysis")
      ->type_name("2|3")
      ->check(CLI::IsMember({2, 3}))
      ->needs(imd)
      ->capture_default_str()
      ->group(group);
  app.add_option("--imd-address", options.imd.address,
                 "Address to serve them on, in numbers; '0.0.0.0' is every network of this "
                 "machine, for networks that you trust")
      ->type_name("ADDR")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return ImdServer::is_address(text) ? std::string()
                                               : "'" + text + "' is not an address in numbers";
          },
          ""))
      ->needs(imd)
      ->capture_default_str()
      ->group(group);
  app.add_option("--imd-wait", options.imd_wait_s,
                 "Before the first tick wait for a viewer, so long at most")
      ->type_name("S")
      ->check(number_within(0, 86400, "a time from 0 to 86400 s"))
      ->needs(imd)
      ->capture_default_str()
      ->group(group);
}

void add_realtime_options(CLI::App& app, PlayOptions& options) {
  const std::string group = "Time";
  app.add_option("--rate", options.rate_hz,
                 "Ticks a second; missed ones are skipped and counted (default: 1000 for a live "
                 "device; a path or replay as fast as possible)")
      ->type_name("HZ")
      ->check(number_within(1e-3, 1e6, "a rate from 0.001 to 1000000 Hz"))
      ->group(group);
  add_number(app, "--duration", options.duration_s, "S",
             "End after this much time of play; 0: when the device ends", 0, 1e9,
             "a time from 0 to 1e9 s")
      ->group(group);
  static const std::map<std::string, RealtimeMode> modes{{"require", RealtimeMode::kRequire},
                                                         {"try", RealtimeMode::kTry},
                                                         {"off", RealtimeMode::kOff}};
  app.add_option_function<std::string>(
         "--realtime", [&](const std::string& name) { options.realtime = modes.at(name); },
         "SCHED_FIFO and locked memory: 'require', 'try' or 'off' (default: try). What was got is "
         "said at the start")
      ->type_name("MODE")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return modes.contains(name) ? std::string()
                                        : "'" + name + "' is not require, try or off";
          },
          ""))
      ->group(group);
  add_number(app, "--spin", options.spin_us, "US",
             "The end of the wait for a tick is spent awake: less late, for that much of a "
             "processor",
             0, 1000, "a time from 0 to 1000 us")
      ->group(group);
  app.add_flag("--selftest", options.selftest,
               "Grade this machine without a device or grid: how late a loop at 1, 2 and 5 kHz "
               "(or --rate) is, beside what the kernel alone gives")
      ->group(group);
  add_number(app, "--selftest-time", options.selftest_s, "S", "How long for each rate", 0.1, 3600,
             "a time from 0.1 to 3600 s")
      ->group(group);
}

}  // namespace

SafetyLimits replay_limits(const CLI::App& app, const PlayOptions& options, SafetyLimits recorded) {
  for (const SafetyOption& o : kSafetyOptions)
    if (app.get_option(o.name)->count() > 0) recorded.*o.value = options.safety.*o.value;
  return recorded;
}

void add_play_options(CLI::App& app, PlayOptions& options) {
  app.config_formatter(std::make_shared<PlayTable>());
  app.allow_config_extras(CLI::config_extras_mode::error);
  app.set_config("--config", "",
                 "Take the options from the table [play] of a TOML file, for which the MODEL.toml "
                 "is a good place; keys are the names below without '--'")
      ->type_name("FILE");
  app.add_option("grid", options.grid, "Complete grid ('-': standard input)")->type_name("GRID");
  app.add_option("--device", options.device, "Device: " + std::string(kDeviceForms))
      ->type_name("DEVICE")
      ->check(CLI::Validator([](const std::string& name) { return device_mistake(name); }, ""));
  app.add_flag("--list-devices", options.list_devices, "List the HID devices of this machine");
  app.add_option("--dump-descriptor", options.dump_descriptor,
                 "Print the report descriptor of a HID device: a path, VID:PID, or serial number, "
                 "as --list-devices shows them")
      ->type_name("WHICH");
  app.add_option("--log", options.log,
                 "File for the log ('-': standard output); FILE.session is compact and can be "
                 "replayed, any other is text")
      ->type_name("FILE");
  app.add_option("--frames", options.frames,
                 "File for the frames, 25 a second ('-': standard output). Without it those of a "
                 "live device go to a pipe on standard output, as in play ... | view")
      ->type_name("FILE");
  app.add_option("--report", options.report,
                 "File for a report as JSON: ticks, lateness, computing time, what the safety core "
                 "did")
      ->type_name("FILE");
  app.add_option("--max-sub-steps", options.max_sub_steps,
                 "A jump over cells is split; with more parts than this it takes several ticks")
      ->type_name("COUNT")
      ->check(number_within(1, 65535, "a count from 1 to 65535"))
      ->capture_default_str();
  add_model_path(app, options.model_path);
  add_imd_options(app, options);
  add_realtime_options(app, options);
  add_safety_options(app, options.safety);
  add_mapping_options(app, options);
  add_pid_options(app, options.pid);
}

}  // namespace hapgrid
