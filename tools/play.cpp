// play: drives a device through a complete grid (Algorithm 2).
#include <malloc.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/loop/realtime.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/signals.hpp"
#include "tools/common/terminal_turn.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/beside.hpp"
#include "tools/play/devices.hpp"
#include "tools/play/instead.hpp"
#include "tools/play/log.hpp"
#include "tools/play/options.hpp"
#include "tools/play/prepared.hpp"
#include "tools/play/report.hpp"
#include "tools/play/viewers.hpp"

using namespace hapgrid;

namespace {

// A loop that is silent for so long will not come back. Devices take their force away long before.
// The end of an adapter takes 4.2 s at most (device/let_go.hpp).
constexpr std::chrono::milliseconds kHungAfter{5000};

constexpr char kHangs[] =
    "play: the haptic loop hangs, in the model or the machine: zero force was sent\n";

// The device of a loop that may compute for ever; null where its guard has sent zero force by then.
Device* without_guard = nullptr;

extern "C" void end_busy_loop(int) {
  if (without_guard) without_guard->stop();  // takes no lock and no memory
  static_cast<void>(!::write(STDERR_FILENO, kHangs, sizeof kHangs - 1));
  ::_exit(kExitFailed);
}

/// @throw Error when the play must not count as done.
void require_good_end(const LoopSummary& s, bool faulted, const RunFacts& facts,
                      const Device& device) {
  if (s.end == LoopExit::kDeviceFailed) throw DeviceError(format("device: {}", device.error()));
  if (!s.zero_sent)
    throw DeviceError(format("device: did not take the last zero force: {}", device.error()));
  if (!faulted) return;
  const bool by_model = facts.traversal == name_of(TraversalRule::kModel);
  const std::string why = s.blocked && by_model ? "the model could not convert a state"
                          : s.blocked           ? "a link of the grid leads nowhere"
                          : s.not_finite        ? "the HIP was not finite"
                                                : "the force was not finite";
  throw Error(
      format("{}: zero force in the last {} of {} ticks", why, s.count_of(kFault), s.ticks));
}

/// Whether a viewer may wait in vain at the end of a pipe, as in `play GRID --device keys | view`:
/// frames go where they were asked for, since a pipe may as well be a log.
bool viewer_waits(const PlayOptions& options) {
  struct stat out {};
  return options.frames.empty() && options.device && is_live(*options.device) &&
         options.log != "-" && options.report != "-" && ::fstat(STDOUT_FILENO, &out) == 0 &&
         S_ISFIFO(out.st_mode);
}

/// What the user gave, and defaults.
PlaySettings given_settings(const PlayOptions& options) {
  PlaySettings settings = changed({}, options.given);
  if (const auto axes = read_axes(options.file.axes)) settings.mapping.axes = *axes;
  return settings;
}

struct Settled {
  PlaySettings settings;
  TraversalRule traversal = kDefaultRule;
  std::string beside = kBesideOn;
};

/// The settings of a play: those that the user gave, then those that a replay recorded, then the
/// defaults. @param session of a replay
Settled settle(const PlayOptions& options, const std::optional<SessionHeader>& session,
               const std::string& grid_digest) {
  Settled settled;
  auto& [settings, rule, beside] = settled;
  if (session) {
    const std::string file = input_file(*options.device);
    if (session->grid_digest != grid_digest)
      say("play", format("{} was recorded with another grid: its forces will be different", file));
    const PlayedWith with = played_with(*session, file);
    settings.safety = with.limits;
    settings.mapping.scale = with.scale;
    rule = with.traversal;
    beside = with.beside;
  }
  settings = changed(settings, options.given);
  if (options.traversal) rule = *options.traversal;
  if (options.beside) beside = *options.beside;
  if (const auto axes = read_axes(options.file.axes)) settings.mapping.axes = *axes;
  return settled;
}

LoopOptions pace(const PlayOptions& options, const OpenDevice& open, double spin_us) {
  LoopOptions loop{.rate_hz = options.rate_hz, .spin_us = spin_us};
  if (open.session) loop.unpaced_hz = open.session->rate_hz;
  if (is_live(*options.device) && loop.rate_hz == 0)
    loop.rate_hz = open.adapter ? open.adapter->rate_hz() : kDefaultRateHz;
  if (open.adapter && loop.rate_hz > open.adapter->rate_hz())
    throw Error(format("--rate: {} takes at most {} forces a second", open.device->info().name,
                       rounded(open.adapter->rate_hz())));
  if (options.duration_s > 0)
    loop.ticks = static_cast<std::uint64_t>(std::ceil(options.duration_s * loop.tick_rate_hz()));
  return loop;
}

/// Ends the program with a zero force when the loop hangs.
std::jthread watch(Device& device, const std::atomic<std::uint64_t>& heartbeat,
                   const LoopOptions& loop) {
  if (!loop.paced()) return {};
  // A loop of less than one tick a second must not seem to hang.
  const std::chrono::milliseconds of_rate(static_cast<int>(4000 / loop.rate_hz));
  return start_watchdog(heartbeat, std::max(kHungAfter, of_rate), [&device] {
    device.stop();
    static_cast<void>(std::fputs(kHangs, stderr));
    ::_exit(kExitFailed);
  });
}

/// Runs the loop to its end, in real time where that is wanted and there is a rate. Says at the
/// start, and in `facts`, what the system gave.
template <class Use>
LoopSummary drive(Device& device, Mapping& mapping, Traversal& traversal, SafetyCore& safety,
                  PlayForce& force, const LoopOptions& loop, RealtimeMode wanted, RunFacts& facts,
                  const Use& use) {
  std::atomic<std::uint64_t> heartbeat{0};
  const std::jthread watchdog = watch(device, heartbeat, loop);
  without_guard = facts.answers ? nullptr : &device;
  ::signal(SIGXCPU, end_busy_loop);  // of Realtime's limit
  const Realtime realtime(loop.paced() ? wanted : RealtimeMode::kOff, &device);
  facts.realtime = realtime.got();
  if (loop.paced())
    say("play", format("{} at {:g} Hz; real time: {}{}", facts.device, loop.rate_hz, facts.realtime,
                       ::isatty(STDERR_FILENO) ? ". Ctrl-C ends it, with zero force" : ""));
  return run_loop(device, mapping, traversal, safety, force, use, caught_signal, heartbeat, loop);
}

/// Prints and writes what happened. @return the exit code @throw Error for a bad end
int conclude(const PlayOptions& options, const LoopSummary& summary, RunFacts facts,
             const SafetyCore& safety, const Device& device, const Viewers& viewers) {
  const bool faulted = safety.faulted();
  const bool bad = summary.end == LoopExit::kDeviceFailed || !summary.zero_sent || faulted;
  facts.exit_code = bad                                 ? kExitFailed
                    : summary.end == LoopExit::kStopped ? 128 + caught_signal.load()
                                                        : kExitDone;
  wait_for_terminal();
  print_summary(summary, facts);
  viewers.print_summary();
  if (!options.report.empty()) write_report(options.report, summary, facts);
  require_good_end(summary, faulted, facts, device);
  return facts.exit_code;
}

/// Adds what a file of --config sets and the command line does not, and says so.
void apply_file(PlayOptions& options) {
  const PlayFile& file = options.file;
  if (file.name.empty()) return;
  say("play", file_text(file, options.given));
  options.given.insert(options.given.begin(), file.given.begin(), file.given.end());
}

/// Opens a device. Where that fails, it says which permissions lack.
ProcessDevice open_alone(const PlayOptions& options) {
  try {
    return ProcessDevice(
        adapter_program(*options.device, given_settings(options), options.rate_hz));
  } catch (const DeviceError&) {
    for (const std::string& help : permissions_lacking()) say("play", help);
    throw;
  }
}

/// Looks at a device without a grid.
int try_it(const PlayOptions& options) {
  const CaughtSignals signals;
  ProcessDevice device = open_alone(options);
  // A person at the terminal can answer questions.
  if (::isatty(STDIN_FILENO) && ::isatty(STDERR_FILENO) && options.duration_s == 0)
    return bring_up(device, options.device_text, options.rate_hz);
  return try_device(device, options.rate_hz, options.duration_s);
}

int play(const PlayOptions& options) {
  if (!options.grid.empty() && viewer_waits(options))
    say("play", "no frames go into the pipe; --frames - sends them to a viewer there");
  require_possible(options);
  if (options.grid.empty()) return try_it(options);
  for (const std::string& input : {options.grid, input_file(*options.device)})
    announce_terminal(input);
  // Where another thread's heap grows, the kernel fills the new pages of locked memory while the
  // loop waits: let it grow seldom, and before the loop begins.
  if (is_live(*options.device)) ::mallopt(M_TOP_PAD, 8 << 20);
  const PlayedGrid grid(options.grid, options.model);
  const GridSpec& spec = grid.spec();

  // A live device is opened last, and signals are caught from then on: one must not leave a
  // terminal without lines and echo. Until then a signal ends the program at once, also while it
  // reads a path from standard input or prepares a large grid.
  const bool live = is_live(*options.device);
  const auto open_it = [&] {
    return open_device(*options.device, given_settings(options), options.rate_hz, spec.box);
  };
  std::optional<OpenDevice> opened;
  if (!live) opened.emplace(open_it());
  auto [settings, rule, wanted_beside] =
      settle(options, opened ? opened->session : std::nullopt, grid.digest);
  Follower follower(grid, rule, wanted_beside, options.beside || !options.model.allowed.empty(),
                    live);
  Beside* const beside = follower.beside.get();

  std::optional<CaughtSignals> signals(std::in_place);
  if (!opened) opened.emplace(open_it());
  const OpenDevice& open = *opened;
  Device& device = *open.device;
  if (open.adapter && !open.adapter->releases() && device.info().max_force > 0)
    say("play",
        format("{}: its adapter has no --release: if it crashes, only the device itself can "
               "take the force away",
               device.info().name));
  if (settings.safety.max_force == 0)
    say("play", "nothing will be felt: max-force is 0. The file of a bring-up says why it is");
  settings.safety.max_force = std::min(settings.safety.max_force, device.info().max_force);
  const LoopOptions loop = pace(options, open, settings.spin_us);
  const double rate_hz = loop.tick_rate_hz();
  Mapping mapping(settings.mapping, device.info(), spec.box);
  SafetyCore safety(settings.safety);
  Viewers viewers(
      options.frames, keys_of(*options.device), spec, grid.create, rate_hz, loop.paced(),
      caught_signal,
      std::min(settings.safety.max_force, settings.safety.gain * follower.force.largest()));
  RunFacts facts{.model = spec.model,
                 .device = device.info().name,
                 .traversal = name_of(rule),
                 .force = follower.force.source(),
                 .rate_hz = loop.rate_hz,
                 .beside = beside,
                 .answers = open.adapter ? &open.adapter->delays() : nullptr,
                 .declared_delay = settings.safety.delay_ticks};
  follower.force.set_device(settings.safety.gain, mapping.scale());
  // As late as possible: an older session of that name is lost now. A signal that came before the
  // first tick leaves it.
  Log log(caught_signal == 0 ? options.log : "", grid, rate_hz, loop.paced(), open.ticks,
          {.limits = settings.safety,
           .scale = mapping.scale(),
           .traversal = rule,
           .beside = beside ? wanted_beside : kBesideOff});
  if (beside) beside->begin(rate_hz);
  std::atomic<std::uint64_t> ticks{0};
  std::optional<ProgressLine> progress;
  if (!loop.paced() && options.frames.empty())  // a viewer shows how far it is
    progress.emplace(
        [&](double) { return format("play: {} ticks", short_number(static_cast<double>(ticks))); });
  const LoopSummary summary =
      drive(device, mapping, *follower.traversal, safety, follower.force, loop,
            options.realtime.value_or(RealtimeMode::kTry), facts, [&](const Tick& tick) {
              log.add(tick);
              viewers.show(tick);
              ticks.fetch_add(1, std::memory_order_relaxed);
            });
  progress.reset();
  signals.reset();  // a second signal may interrupt the writing of what is left
  give_up_unread_messages();
  log.finish();
  viewers.finish();
  facts.frames = viewers.frames();
  return conclude_without(
      beside, [&] { return conclude(options, summary, facts, safety, device, viewers); });
}

int run(PlayOptions options) {
  apply_file(options);
  if (options.selftest) return run_selftest(options);
  if (options.list_devices) {
    std::cout << devices_table();
    return kExitDone;
  }
  try {
    return play(options);
  } catch (const std::system_error& e) {
    // A signal that came before the loop, while a pipe waited for its reader.
    if (e.code() == std::errc::interrupted && caught_signal != 0) return 128 + caught_signal;
    throw;
  }
}

}  // namespace

int main(int argc, char** argv) {
  PlayOptions options;
  CommandLine app(
      "Drives a device through a complete grid: reads the HIP, follows the levels of the grid's "
      "cells, interpolates energy or state, and sends the force through the safety core to the "
      "device.");
  app.set_help(
      "play",
      "Devices:\n"
      "  path:FILE         positions in a file; 'path:-' reads standard input\n"
      "  keys              this terminal's keyboard\n"
      "  replay:FILE       what a log has\n"
      "  hid:PROFILE       a HID device that a text file describes\n"
      "  evdev[:WHICH]     a gamepad, stick or wheel\n"
      "  spacemouse[:WHICH]  a SpaceMouse, which moves the HIP but cannot show forces\n"
      "  process:COMMAND   an adapter program, for a device with its maker's library\n"
      "WHICH is a path, VID:PID, VID:PID:SERIAL or serial number; --list-devices has\n"
      "the text for each device. Without GRID, at a terminal, play brings one of the\n"
      "last four up: it finds axes, signs, encoder and delay, and pushes with 0.1 N at\n"
      "most if you say yes. It writes a file for --config to standard output.\n"
      "\n"
      "Settings, keys of the table [play] of --config:\n" +
          settings_help() +
          "\n"
          "Keyboard: the arrows move the HIP along x and z, page up and down along y.\n"
          "+ and - change the step, 0 goes back to the start, n goes on to the next level\n"
          "at this place, r lets the force come back after a fault, and q ends the play.\n",
      "  129, 130, 131, 143, 148  ended by SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP:\n"
      "     zero force was sent, and the log so far is complete\n");
  add_play_options(app, options);
  return run_tool(app, argc, argv, [&] { return run(options); });
}
