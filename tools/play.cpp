// play: drives a device through a complete grid (Algorithm 2).
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/haptic/watchdog.hpp"
#include "libcore/model/fields.hpp"
#include "libcore/shard/load.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/devices.hpp"
#include "tools/play/log.hpp"
#include "tools/play/options.hpp"
#include "tools/play/report.hpp"
#include "tools/play/selftest.hpp"
#include "tools/play/signals.hpp"
#include "tools/play/viewers.hpp"

using namespace hapgrid;

namespace {

// A loop that is silent for so long does not come back by itself; devices let go long before.
constexpr std::chrono::milliseconds kHungAfter{2000};

/// @throw Error for a run that must not count as done.
void require_good_end(const LoopSummary& s, const SafetyCore& safety, const Device& device) {
  if (s.end == LoopEnd::kDeviceFailed) throw DeviceError("device: " + device.error());
  if (!s.zero_sent)
    throw DeviceError("device: did not take the last zero force: " + device.error());
  if (!safety.faulted()) return;
  const std::string why = s.blocked      ? "a link of the grid leads nowhere"
                          : s.not_finite ? "the HIP was not finite"
                                         : "the force was not finite";
  throw Error(why + ": zero force in the last " + std::to_string(s.count_of(kFault)) + " of " +
              std::to_string(s.ticks) + " ticks");
}

/// What the command line says twice or not at all.
void check(const PlayOptions& options) {
  if (options.grid.empty()) throw CLI::RequiredError("grid");
  if (options.device.empty()) throw CLI::RequiredError("--device");
  if (options.grid == "-" && device_file(options.device) == "-")
    throw CLI::ValidationError("the grid and the path cannot both be standard input");
  const auto same = [](const std::string& a, const std::string& b) {
    std::error_code ignored;  // one of them is no file: then they are not the same
    return !a.empty() && (a == b || std::filesystem::equivalent(a, b, ignored));
  };
  struct Output {
    const char* option;
    const char* what;
    const std::string& file;
  };
  const std::string input = device_file(options.device);
  const Output outputs[] = {{"--log", "the log", options.log},
                            {"--frames", "the frames", options.frames},
                            {"--report", "the report", options.report}};
  for (const Output& output : outputs)
    if (output.file != "-" && (same(output.file, options.grid) || same(output.file, input)))
      throw CLI::ValidationError(output.option, std::string(output.what) + " would replace the " +
                                                    (same(output.file, input) ? "path or session "
                                                                                "that is played"
                                                                              : "grid"));
  for (std::size_t i = 0; i < std::size(outputs); ++i)
    for (std::size_t j = i + 1; j < std::size(outputs); ++j)
      if (same(outputs[i].file, outputs[j].file))
        throw CLI::ValidationError(std::string(outputs[i].option) + " and " + outputs[j].option +
                                   " cannot both be " + outputs[j].file);
  if (!options.log.empty() && !is_session_name(options.log) && is_live(options.device))
    throw CLI::ValidationError(
        "--log",
        "a text is kept in memory until the end, which a live device does not have: name it "
        "FILE.session (stats --log FILE.session --export makes it a text)");
  if (options.frames == "-" && ::isatty(STDOUT_FILENO))
    throw Error("standard output is a terminal: redirect it, or name a file after --frames");
}

/// What a replay was played with counts, but for what the command line says.
PlayedWith resume(const CLI::App& app, const PlayOptions& options, const SessionHeader& session,
                  const LoadedGrid& loaded) {
  const std::string file = options.device.substr(options.device.find(':') + 1);
  if (session.grid_digest != loaded.digest)
    std::fprintf(stderr, "play: %s was recorded with another grid: its forces will be others\n",
                 file.c_str());
  PlayedWith with = played_with(session, file);
  with.limits = replay_limits(app, options, with.limits);
  if (app.get_option("--scale")->count() > 0) with.scale = options.mapping.scale;
  return with;
}

int play(const CLI::App& app, PlayOptions options) {
  // Frames go where a viewer waits: play GRID --device keys | view. A scripted play may be in a
  // script that collects what its commands say.
  struct stat out {};
  if (options.frames.empty() && is_live(options.device) && options.log != "-" &&
      options.report != "-" && ::fstat(STDOUT_FILENO, &out) == 0 && S_ISFIFO(out.st_mode))
    options.frames = "-";
  check(options);
  std::optional<HidGuard> guard;  // before there is a thread, or a grid that a fork would copy
  if (needs_guard(options.device)) {
    const rlimit no_core{0, 0};  // writing one would keep the guard waiting
    ::setrlimit(RLIMIT_CORE, &no_core);
    guard.emplace();
  }
  Viewers viewers(options);
  const LoadedGrid loaded = load_grid(options.grid);
  const Grid& grid = loaded.grid;
  require_playable(grid, options.grid == "-" ? "standard input" : options.grid);
  const GridSpec& spec = grid.spec();
  const auto create = [&] {
    return Plugin(spec.model, model_path(options.model_path)).create(spec.parameters);
  };
  const Fields fields(spec, create, /*wants_shape=*/false);

  // Before a live device is open: a signal must not leave a terminal without lines and echo.
  // Reading a path from standard input still ends by it.
  std::optional<CaughtSignals> signals;
  if (is_live(options.device)) signals.emplace();
  const OpenDevice open = open_device(options, spec.box, guard ? &*guard : nullptr);
  if (!signals) signals.emplace();
  Device& device = *open.device;
  const DeviceInfo info = device.info();
  PlayedWith with{.limits = options.safety, .scale = options.mapping.scale};
  if (open.session) with = resume(app, options, *open.session, loaded);
  with.limits.max_force = std::min(with.limits.max_force, info.max_force);
  options.mapping.scale = with.scale;
  LoopOptions loop{.rate_hz = options.rate_hz, .spin_us = options.spin_us};
  if (open.session) loop.unpaced_hz = open.session->rate_hz;
  if (open.live && loop.rate_hz == 0) loop.rate_hz = kDefaultRateHz;
  const bool paced = loop.rate_hz > 0;
  const double rate_hz = paced ? loop.rate_hz : loop.unpaced_hz;

  if (options.duration_s > 0)
    loop.ticks = static_cast<std::uint64_t>(std::ceil(options.duration_s * rate_hz));

  Mapping mapping(options.mapping, info, spec.box);
  with.scale = mapping.scale();
  Traversal traversal(grid, options.max_sub_steps);
  SafetyCore safety(with.limits);
  Log log(options.log, loaded, fields, rate_hz, paced, open.ticks, with);
  viewers.start(spec, create, rate_hz, paced, caught_signal);

  const auto force = [&](const Vec3& x, std::span<const double> row) {
    return fields.force(x, row);
  };
  const auto sink = [&](const Tick& tick) {
    log.add(tick);
    viewers.show(tick);
  };
  RunFacts facts{.model = spec.model, .device = info.name, .rate_hz = loop.rate_hz};
  LoopSummary summary;
  {
    std::atomic<std::uint64_t> heartbeat{0};
    std::optional<Watchdog> watchdog;
    if (paced)
      // A loop below one tick in a second would seem to hang.
      watchdog.emplace(
          heartbeat,
          std::max(kHungAfter, std::chrono::milliseconds(static_cast<int>(4000 / loop.rate_hz))),
          [&device] {
            device.stop();
            static_cast<void>(
                std::fputs("play: the haptic loop hangs, in the model or the machine: zero force "
                           "was sent\n",
                           stderr));
            ::_exit(kExitFailed);
          });
    viewers.wait(caught_signal);
    const Realtime realtime(paced ? options.realtime : RealtimeMode::kOff);
    facts.realtime = realtime.got();
    if (paced)
      std::fprintf(stderr, "play: %s at %g Hz; real time: %s\n", info.name.c_str(), loop.rate_hz,
                   facts.realtime.c_str());
    summary =
        run_loop(device, mapping, traversal, safety, force, sink, caught_signal, heartbeat, loop);
    signals.reset();  // writing what is left can be interrupted
  }
  log.finish();
  viewers.finish();
  facts.frames = viewers.frames();
  const bool bad = summary.end == LoopEnd::kDeviceFailed || !summary.zero_sent || safety.faulted();
  facts.exit_code = bad                                ? kExitFailed
                    : summary.end == LoopEnd::kStopped ? 128 + caught_signal.load()
                                                       : kExitDone;
  print_summary(summary, facts);
  viewers.print_summary();
  if (!options.report.empty()) write_report(options.report, summary, facts);
  require_good_end(summary, safety, device);
  return facts.exit_code;
}

int run(const CLI::App& app, const PlayOptions& options) {
  if (options.selftest) return run_selftest(options);
  if (options.list_devices) {
    print_devices();
    return kExitDone;
  }
  if (!options.dump_descriptor.empty()) {
    print_descriptor(options.dump_descriptor);
    return kExitDone;
  }
  try {
    return play(app, options);
  } catch (const std::system_error& e) {
    // A signal before the loop, while a pipe waited for its reader.
    if (e.code() == std::errc::interrupted && caught_signal != 0) return 128 + caught_signal;
    throw;
  }
}

}  // namespace

int main(int argc, char** argv) {
  PlayOptions options;
  CLI::App app(
      "Drives a device through a complete grid: reads the HIP, follows the levels of the grid's\n"
      "cells, interpolates the state, computes the force with the grid's model, or interpolates "
      "it\n"
      "where the grid keeps it, and sends it.");
  describe(
      app, "play",
      "A path is a text: x y z a line, in the model's unit of length, separated by spaces or\n"
      "tabs; '#' starts a comment, blank lines are skipped.\n"
      "\n"
      "Keys: arrows left and right move the HIP along x, up and down along z, page up and down\n"
      "along y; + and - make the steps larger and smaller, 0 goes back to the start, r lets the\n"
      "force come back after a fault, q ends.\n"
      "\n"
      "The text log has a line a tick, tab-separated, numbers with 17 digits; its first line\n"
      "starts with '#' and names the columns:\n" +
          std::string(kTextLogHelp) +
          "\n"
          "A log FILE.session has every tick with the force as it was and as it was sent, levels, "
          "what\n"
          "the safety core did, and how late the tick was, in some 25 bytes a tick; stats --log "
          "draws\n"
          "it and makes it a text. Replayed with --device replay:FILE, with the same grid, it "
          "gives\n"
          "the same forces bit for bit: safety, scale and rate are the session's, but for what "
          "the\n"
          "command line says.\n"
          "\n"
          "Frames are Cap'n Proto messages (schemas/frame.capnp) for view, 25 a second. With "
          "--rate\n"
          "the newest tick is taken each time; a viewer that is slow, asleep or gone never makes "
          "a\n"
          "tick late: it misses frames, which are counted, and after the end it has a second to "
          "read\n"
          "what is left. Without --rate a frame is a tick in 40 (of a session at 5 kHz in 200), "
          "the\n"
          "first and the last one among them, and play waits for the viewer.\n"
          "\n"
          "With --imd viewers of molecules get the same frames over TCP, up to 8 at once: VMD "
          "(IMD\n"
          "version 2) and MDAnalysis (version 3). Atoms are the model's spheres, and the HIP, held "
          "in\n"
          "the box, as one more at the end; VMD and MDAnalysis want to know them beforehand, as "
          "from\n"
          "view --xyz FILE --hip-label Xx. Lengths are converted from m, mm, nm, angstrom, pm or\n"
          "bohr to angstrom, energies from kJ/mol, kcal/mol, J, eV or hartree to kcal/mol (2) or\n"
          "kJ/mol (3); other units go out as they are. Version 3 also has time (ps), the grid's "
          "box,\n"
          "which is not periodic, and the force on the HIP as it was sent, 1 N being 6.022e10\n"
          "kJ/(mol angstrom). Viewers look on: forces and rates that they send are ignored; "
          "pausing,\n"
          "disconnecting and killing concern the viewer itself alone. One that reads too slowly\n"
          "misses frames, and is closed when it takes more than 5 s for one. With --rate nobody "
          "is\n"
          "ever waited for, but a second after the end; without it a frame waits 40 ms at most.\n"
          "\n"
          "A force that is not finite is never sent: it is zero from there on, and the exit code\n"
          "is 1, unless you let it come back: key r, the clutch of a profile, the first button of "
          "a\n"
          "PID joystick, any button of a SpaceMouse. A tick is late from when it was due to when "
          "it began; computing is from there to\n"
          "when its force was sent.\n",
      "  129, 130, 131, 143, 148  ended by SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP: zero force\n"
      "                 was sent, and the log so far is complete\n");
  add_play_options(app, options);
  return run_tool(app, argc, argv, [&] { return run(app, options); });
}
