// play: drives a device through a complete grid (Algorithm 2).
#include <unistd.h>

#include <algorithm>
#include <chrono>
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
#include "tools/play/options.hpp"
#include "tools/play/report.hpp"
#include "tools/play/selftest.hpp"
#include "tools/play/signals.hpp"
#include "tools/play/text_log.hpp"
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
  if (options.grid == "-" && reads_standard_input(options.device))
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
  const Output outputs[] = {{"--log", "the log", options.log},
                            {"--frames", "the frames", options.frames},
                            {"--report", "the report", options.report}};
  for (const Output& output : outputs)
    if (output.file != "-" && same(output.file, options.grid))
      throw CLI::ValidationError(output.option,
                                 std::string(output.what) + " would replace the grid");
  for (std::size_t i = 0; i < std::size(outputs); ++i)
    for (std::size_t j = i + 1; j < std::size(outputs); ++j)
      if (same(outputs[i].file, outputs[j].file))
        throw CLI::ValidationError(std::string(outputs[i].option) + " and " + outputs[j].option +
                                   " cannot both be " + outputs[j].file);
  if (options.frames == "-" && ::isatty(STDOUT_FILENO))
    throw Error("standard output is a terminal: redirect it, or name a file after --frames");
}

int play(const PlayOptions& options) {
  check(options);
  Viewers viewers(options);
  const LoadedGrid loaded = load_grid({options.grid});
  const Grid& grid = loaded.grid;
  require_playable(grid, options.grid == "-" ? "standard input" : options.grid);
  const GridSpec& spec = grid.spec();
  const auto create = [&] {
    return Plugin(spec.model, model_path(options.model_path)).create(spec.parameters);
  };
  const Fields fields(spec, create, /*wants_shape=*/false);

  const OpenDevice open = open_device(options, spec.box);
  Device& device = *open.device;
  const DeviceInfo info = device.info();
  LoopOptions loop{.rate_hz = options.rate_hz, .spin_us = options.spin_us};
  if (open.live && loop.rate_hz == 0) loop.rate_hz = kDefaultRateHz;
  const bool paced = loop.rate_hz > 0;
  const double rate_hz = paced ? loop.rate_hz : kUnpacedHz;

  Mapping mapping(options.mapping, info, spec.box);
  Traversal traversal(grid, options.max_sub_steps);
  SafetyLimits limits = options.safety;
  limits.max_force = std::min(limits.max_force, info.max_force);
  SafetyCore safety(limits);

  // A paced run must not write before its end, so all its ticks find room; without deadlines the
  // sink writes whenever the storage is full.
  constexpr std::size_t kChunk = 4096;
  std::optional<TextLog> log;
  if (!options.log.empty())
    log.emplace(options.log, spec, fields, rate_hz,
                paced ? open.ticks : std::min(open.ticks, kChunk));
  viewers.start(spec, create, rate_hz, paced, caught_signal);

  const auto force = [&](const Vec3& x, std::span<const double> row) {
    return fields.force(x, row);
  };
  const auto sink = [&](const Tick& tick) {
    if (log) {
      if (log->full()) log->flush();
      log->add(tick);
    }
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
    const CaughtSignals signals;
    viewers.wait(caught_signal);
    const Realtime realtime(paced ? options.realtime : RealtimeMode::kOff);
    facts.realtime = realtime.got();
    if (open.live || options.realtime == RealtimeMode::kRequire)
      std::fprintf(stderr, "play: %s at %g Hz; real time: %s\n", info.name.c_str(), loop.rate_hz,
                   facts.realtime.c_str());
    summary =
        run_loop(device, mapping, traversal, safety, force, sink, caught_signal, heartbeat, loop);
  }
  if (log) {
    log->flush();
    log->commit();
  }
  viewers.finish();
  facts.frames = viewers.frames();
  facts.exit_code = summary.end == LoopEnd::kStopped ? 128 + caught_signal.load()
                    : summary.end == LoopEnd::kDeviceFailed || safety.faulted() ? kExitFailed
                                                                                : kExitDone;
  print_summary(summary, facts);
  viewers.print_summary();
  if (!options.report.empty()) write_report(options.report, summary, facts);
  require_good_end(summary, safety, device);
  return facts.exit_code;
}

int run(const PlayOptions& options) {
  if (options.selftest) return run_selftest(options);
  return play(options);
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
          "Frames are Cap'n Proto messages (schemas/frame.capnp) for view, 25 a second. With "
          "--rate\n"
          "the newest tick is taken each time; a viewer that is slow, asleep or gone never makes "
          "a\n"
          "tick late: it misses frames, which are counted, and after the end it has a second to "
          "read\n"
          "what is left. Without --rate a frame is a tick in 40, the first and the last one among\n"
          "them, and play waits for the viewer.\n"
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
          "is 1. A tick is late from when it was due to when it began; computing is from there to\n"
          "when its force was sent.\n",
      "  129, 130, 143  ended by SIGHUP, SIGINT, SIGTERM: zero force was sent, and the log so\n"
      "                 far is complete\n");
  add_play_options(app, options);
  return run_tool(app, argc, argv, [&] { return run(options); });
}
