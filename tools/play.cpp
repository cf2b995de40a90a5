// play: drives a device through a complete grid (Algorithm 2).
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/text.hpp"
#include "libcore/device/path.hpp"
#include "libcore/haptic/loop.hpp"
#include "libcore/model/fields.hpp"
#include "libcore/scene/publisher.hpp"
#include "libcore/shard/load.hpp"
#include "tools/common/tool.hpp"

using namespace hapgrid;

namespace {

constexpr double kUnpacedHz = 1000;  // what a tick is worth in log and frames without a pace
constexpr std::string_view kPathDevice = "path:";

struct Options {
  std::string grid;
  std::string device;
  double rate_hz = 0;  // 0: as fast as possible
  std::string log;
  std::string frames;
  std::vector<std::string> model_path;
  double max_force = SafetyLimits{}.max_force;
  std::uint16_t max_sub_steps = Traversal::kDefaultMaxSubSteps;
};

/// The ticks of a run as text. They are kept as numbers in storage that is allocated beforehand;
/// formatting and writing happen in flush() only, outside the tick.
class Log {
 public:
  /// @param fields for the column of energies, which is there if they have any.
  Log(const std::string& file, const GridSpec& spec, const Fields& fields, double rate_hz,
      std::size_t capacity)
      : output_(file, false),
        spec_(spec),
        fields_(fields),
        rate_hz_(rate_hz),
        columns_(7 + spec.state_size),
        capacity_(capacity) {
    numbers_.resize(capacity * columns_);
    if (spec.stored.energy)
      energies_.resize(capacity);
    else if (fields.has_energy())
      positions_.resize(capacity);
    levels_.resize(capacity);
    text_ = "# t\tx\ty\tz\tfx\tfy\tfz";
    for (int i = 0; i < 8; ++i) text_ += "\tl" + std::to_string(i);
    for (std::size_t i = 0; i < spec.state_size; ++i) text_ += "\ts" + std::to_string(i);
    if (fields.has_energy()) text_ += "\tenergy";
    text_ += '\n';
    output_.write(text_);
  }

  bool full() const { return size_ == capacity_; }

  /// Real-time safe; not when full().
  void add(const Tick& tick) noexcept {
    double* to = numbers_.data() + size_ * columns_;
    *to++ = static_cast<double>(tick.number) / rate_hz_;
    for (const double x : tick.hip) *to++ = x;
    for (const double f : tick.force.force) *to++ = f;
    for (const double s : tick.traversal.state()) *to++ = s;
    if (!energies_.empty()) energies_[size_] = tick.traversal.row()[spec_.energy_offset()];
    if (!positions_.empty()) positions_[size_] = tick.traversal.position();
    levels_[size_++] = tick.traversal.levels();
  }

  void flush() {
    text_.clear();
    for (std::size_t row = 0; row < size_; ++row) {
      const std::span<const double> numbers(numbers_.data() + row * columns_, columns_);
      for (std::size_t i = 0; i < 7; ++i) append(numbers[i], i == 0 ? "" : "\t");
      for (const Level level : levels_[row]) text_ += '\t' + std::to_string(level);
      for (std::size_t i = 7; i < columns_; ++i) append(numbers[i], "\t");
      if (!energies_.empty()) append(energies_[row], "\t");
      if (!positions_.empty()) append(fields_.energy(positions_[row], numbers.subspan(7)), "\t");
      text_ += '\n';
      if (text_.size() < kWriteBytes) continue;
      output_.write(text_);
      text_.clear();
    }
    output_.write(text_);
    size_ = 0;
  }

  void commit() { output_.commit(); }

 private:
  static constexpr std::size_t kWriteBytes = 1 << 16;

  void append(double value, const char* separator) {
    text_ += separator;
    append_digits17(text_, value);
  }

  OutputFile output_;
  const GridSpec& spec_;
  const Fields& fields_;
  double rate_hz_;
  std::size_t columns_;  // t, the HIP, the force, the state
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::vector<double> numbers_;
  std::vector<std::array<Level, 8>> levels_;
  std::vector<double> energies_;  // where they are stored; else
  std::vector<Vec3> positions_;   // where they belong to: they are computed when they are written
  std::string text_;
};

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What the frames show of the grid's model.
Scene describe_scene(const GridSpec& spec, const Fields& fields) {
  return {.model = spec.model,
          .length_unit = spec.length_unit,
          .energy_unit = spec.energy_unit,
          .box = spec.box,
          .state_size = spec.state_size,
          .hip_radius = spec.hip_radius,
          .spheres = fields.spheres()};
}

/// Energy and shape of a frame.
void complete(const Fields& fields, Frame& frame) {
  if (fields.has_energy()) frame.energy = fields.energy(frame.position, frame.row);
  fields.shape(frame.row, frame.centres);
}

/// Real-time safe: the snapshot's vectors have their sizes already.
void fill(Snapshot& snapshot, const Tick& tick, double rate_hz, const Vec3& raw_force) noexcept {
  snapshot.tick = tick.number;
  snapshot.time_s = static_cast<double>(tick.number) / rate_hz;
  snapshot.hip = tick.hip;
  snapshot.position = tick.traversal.position();
  snapshot.force = tick.force.force;
  snapshot.raw_force = raw_force;
  snapshot.levels = tick.traversal.levels();
  const auto row = tick.traversal.row();
  std::copy(row.begin(), row.end(), snapshot.row.begin());
}

std::atomic<int> caught_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);  // a handler may touch nothing else

extern "C" void catch_signal(int signal) { caught_signal.store(signal, std::memory_order_relaxed); }

/// While it lives SIGINT, SIGTERM and SIGHUP set caught_signal instead of ending the process;
/// one that was ignored stays ignored (nohup).
class CaughtSignals {
 public:
  CaughtSignals() {
    struct sigaction action {};
    action.sa_handler = catch_signal;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      ::sigaction(kSignals[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) ::sigaction(kSignals[i], &action, nullptr);
    }
  }
  ~CaughtSignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i)
      ::sigaction(kSignals[i], &before_[i], nullptr);
  }
  CaughtSignals(const CaughtSignals&) = delete;
  CaughtSignals& operator=(const CaughtSignals&) = delete;

 private:
  static constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> before_{};
};

void print_summary(const LoopSummary& s, double rate_hz) {
  const auto n = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
  std::fprintf(stderr,
               "play: %llu ticks, %llu cell switches: %llu face, %llu edge, %llu vertex; levels "
               "changed in %llu ticks\n",
               n(s.ticks), n(s.face_switches + s.edge_switches + s.vertex_switches),
               n(s.face_switches), n(s.edge_switches), n(s.vertex_switches), n(s.level_changed));
  std::fprintf(stderr,
               "play: ticks outside the box %llu, with a jump split %llu, lagging behind a jump "
               "%llu, with the force limited %llu\n",
               n(s.outside), n(s.split), n(s.lagging), n(s.clamped));
  if (rate_hz > 0)
    std::fprintf(stderr, "play: ticks missed at %g Hz: %llu\n", rate_hz, n(s.missed));
}

void print_frames(const FrameCounts& c) {
  std::fprintf(stderr, "play: frames written %llu, dropped %llu%s\n",
               static_cast<unsigned long long>(c.written),
               static_cast<unsigned long long>(c.dropped),
               c.closed ? "; the viewer closed its end before the last one"
               : c.cut  ? "; the viewer stopped reading, the last one is cut"
                        : "");
}

/// @throw Error for a run that must not count as done.
void require_good_end(const LoopSummary& s, const Device& device) {
  if (s.end == LoopEnd::kDeviceFailed) throw DeviceError("device: " + device.error());
  if (!s.zero_sent)
    throw DeviceError("device: did not take the last zero force: " + device.error());
  if (s.faulted == 0) return;
  const std::string why = s.blocked      ? "a link of the grid leads nowhere"
                          : s.not_finite ? "the HIP was not finite"
                                         : "the force was not finite";
  throw Error(why + ": zero force in the last " + std::to_string(s.faulted) + " of " +
              std::to_string(s.ticks) + " ticks");
}

int run(const Options& options) {
  const std::string path = options.device.substr(kPathDevice.size());
  if (options.grid == "-" && path == "-")
    throw CLI::ValidationError("the grid and the path cannot both be standard input");
  std::error_code ignored;  // one of them is no file: then they are not the same
  if (std::filesystem::equivalent(options.log, options.grid, ignored))
    throw CLI::ValidationError("--log", "the log would replace the grid");
  if (std::filesystem::equivalent(options.frames, options.grid, ignored))
    throw CLI::ValidationError("--frames", "the frames would replace the grid");
  if (!options.frames.empty() &&
      (options.frames == options.log ||
       std::filesystem::equivalent(options.frames, options.log, ignored)))
    throw CLI::ValidationError("--log and --frames cannot both be " + options.frames);
  if (options.frames == "-" && ::isatty(STDOUT_FILENO))
    throw Error("standard output is a terminal: redirect it, or name a file after --frames");

  PathDevice device = PathDevice::open(path);
  const LoadedGrid loaded = load_grid({options.grid});
  const Grid& grid = loaded.grid;
  require_playable(grid, options.grid == "-" ? "standard input" : options.grid);

  const GridSpec& spec = grid.spec();
  const auto create = [&] {
    return Plugin(spec.model, model_path(options.model_path)).create(spec.parameters);
  };
  const Fields fields(spec, create, /*wants_shape=*/false);

  Traversal traversal(grid, options.max_sub_steps);
  SafetyCore safety({.max_force = options.max_force});
  // A paced run must not write before its end, so all its ticks find room; without deadlines the
  // sink writes whenever the storage is full.
  const bool paced = options.rate_hz > 0;
  const double rate_hz = paced ? options.rate_hz : kUnpacedHz;
  constexpr std::size_t kChunk = 4096;
  std::optional<Log> log;
  if (!options.log.empty())
    log.emplace(options.log, spec, fields, rate_hz,
                paced ? device.size() : std::min(device.size(), kChunk));
  std::optional<Fields> slow_fields;  // of the frames' thread
  std::optional<FramePublisher> frames;
  if (!options.frames.empty()) {
    slow_fields.emplace(spec, create, /*wants_shape=*/true);
    frames.emplace(
        OutputFile(options.frames, /*binary=*/false), describe_scene(spec, *slow_fields),
        spec.row_size(), [&](Frame& frame) { complete(*slow_fields, frame); }, paced, kUnpacedHz,
        caught_signal);
  }

  constexpr Vec3 kNotComputed{kNaN, kNaN, kNaN};
  Vec3 raw_force = kNotComputed;
  const auto force = [&](const Vec3& x, std::span<const double> row) {
    return raw_force = fields.force(x, row);
  };
  const auto sink = [&](const Tick& tick) {
    if (log) {
      if (log->full()) log->flush();
      log->add(tick);
    }
    if (frames) {
      fill(frames->next(), tick, rate_hz, raw_force);
      frames->publish();
      raw_force = kNotComputed;
    }
  };
  LoopSummary summary;
  {
    const CaughtSignals signals;
    summary = run_loop(device, traversal, safety, force, sink, caught_signal, options.rate_hz);
  }
  if (log) {
    log->flush();
    log->commit();
  }
  std::optional<FrameCounts> counts;
  if (frames) counts = frames->finish();
  print_summary(summary, options.rate_hz);
  if (counts) print_frames(*counts);
  require_good_end(summary, device);
  return summary.end == LoopEnd::kStopped ? 128 + caught_signal.load() : kExitDone;
}

/// A number in [low, high]; CLI::Range lets NaN pass.
CLI::Validator number_within(double low, double high, const std::string& description) {
  return CLI::Validator(
      [=](const std::string& text) {
        double value = std::nan("");
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high)
          return std::string();
        return "'" + text + "' is not " + description;
      },
      "");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
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
      "The log has a line a tick, tab-separated, numbers with 17 digits; its first line starts\n"
      "with '#' and names the columns:\n"
      "  t          time of the tick in seconds: its number divided by --rate, or by 1000\n"
      "             without it; missed ticks count\n"
      "  x y z      HIP as the device gave it; outside the box it is held at the box's edge,\n"
      "             where state and force belong to\n"
      "  fx fy fz   force in newtons as it was sent\n"
      "  l0 ... l7  levels in the corners i + 2j + 4k of the cell\n"
      "  s0 ...     interpolated state, in the model's units\n"
      "  energy     of that state with the HIP there, in the model's unit; only if the grid or\n"
      "             its model has energies\n"
      "\n"
      "Frames are Cap'n Proto messages (schemas/frame.capnp) for view, 25 a second. With --rate\n"
      "the newest tick is taken each time; a viewer that is slow, asleep or gone never makes a\n"
      "tick late: it misses frames, which are counted, and after the end it has a second to read\n"
      "what is left. Without --rate a frame is a tick in 40, the first and the last one among\n"
      "them, and play waits for the viewer.\n"
      "\n"
      "A force that is not finite is never sent: it is zero from there on, and the exit code\n"
      "is 1.\n",
      "  129, 130, 143  ended by SIGHUP, SIGINT, SIGTERM: zero force was sent, and the log so\n"
      "                 far is complete\n");
  app.add_option("grid", options.grid, "Complete grid ('-': standard input)")
      ->type_name("GRID")
      ->required();
  app.add_option("--device", options.device,
                 "Device: path:FILE moves the HIP through the positions in FILE ('path:-': "
                 "standard input)")
      ->type_name("DEVICE")
      ->required()
      ->check(CLI::Validator(
          [](const std::string& name) {
            return name.size() > kPathDevice.size() && name.starts_with(kPathDevice)
                       ? std::string()
                       : "'" + name + "' is not a device: path:FILE";
          },
          ""));
  app.add_option("--rate", options.rate_hz,
                 "Ticks a second; missed ones are skipped and counted (default: as fast as "
                 "possible)")
      ->type_name("HZ")
      ->check(number_within(1e-3, 1e6, "a rate from 0.001 to 1000000 Hz"));
  app.add_option("--log", options.log, "File for the log ('-': standard output)")
      ->type_name("FILE");
  app.add_option("--frames", options.frames,
                 "File for the frames, 25 a second ('-': standard output), as in play ... "
                 "--frames - | view")
      ->type_name("FILE");
  app.add_option("--max-force", options.max_force,
                 "Largest magnitude of the force, in newtons; a larger one is scaled down")
      ->type_name("N")
      ->check(number_within(0, 1e6, "a force from 0 to 1000000 N"))
      ->capture_default_str();
  app.add_option("--max-sub-steps", options.max_sub_steps,
                 "A jump over cells is split; with more parts than this it takes several ticks")
      ->type_name("COUNT")
      ->check(number_within(1, 65535, "a count from 1 to 65535"))
      ->capture_default_str();
  add_model_path(app, options.model_path);
  return run_tool(app, argc, argv, [&] { return run(options); });
}
