// play: drives a device through a complete grid (Algorithm 2).
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
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
#include "libcore/model/model.hpp"
#include "libcore/shard/load.hpp"
#include "tools/common/tool.hpp"

using namespace hapgrid;

namespace {

constexpr double kUnpacedHz = 1000;  // what a tick is worth in the log when nothing paces it
constexpr std::string_view kPathDevice = "path:";

struct Options {
  std::string grid;
  std::string device;
  double rate_hz = 0;  // 0: as fast as possible
  std::string log;
  std::vector<std::string> model_path;
  double max_force = SafetyLimits{}.max_force;
  std::uint16_t max_sub_steps = Traversal::kDefaultMaxSubSteps;
};

/// The ticks of a run as text. They are kept as numbers in storage that is allocated beforehand;
/// formatting and writing happen in flush() only, outside the tick.
class Log {
 public:
  Log(const std::string& file, std::size_t state_size, double rate_hz, std::size_t capacity)
      : output_(file, false), rate_hz_(rate_hz), columns_(7 + state_size), capacity_(capacity) {
    numbers_.resize(capacity * columns_);
    levels_.resize(capacity);
    text_ = "# t\tx\ty\tz\tfx\tfy\tfz";
    for (int i = 0; i < 8; ++i) text_ += "\tl" + std::to_string(i);
    for (std::size_t i = 0; i < state_size; ++i) text_ += "\ts" + std::to_string(i);
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
    levels_[size_++] = tick.traversal.levels();
  }

  void flush() {
    text_.clear();
    for (std::size_t row = 0; row < size_; ++row) {
      const std::span<const double> numbers(numbers_.data() + row * columns_, columns_);
      for (std::size_t i = 0; i < 7; ++i) append(numbers[i], i == 0 ? "" : "\t");
      for (const Level level : levels_[row]) text_ += '\t' + std::to_string(level);
      for (std::size_t i = 7; i < columns_; ++i) append(numbers[i], "\t");
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
  double rate_hz_;
  std::size_t columns_;  // t, the HIP, the force, the state
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::vector<double> numbers_;
  std::vector<std::array<Level, 8>> levels_;
  std::string text_;
};

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

  PathDevice device = PathDevice::open(path);
  const LoadedGrid loaded = load_grid({options.grid});
  const Grid& grid = loaded.grid;
  require_playable(grid, options.grid == "-" ? "standard input" : options.grid);

  const GridSpec& spec = grid.spec();
  const Model model = Plugin(spec.model, model_path(options.model_path)).create(spec.parameters);
  if (model.state_size() != spec.state_size)
    throw ModelError("model " + spec.model + ": states of " + std::to_string(model.state_size()) +
                     " values, the grid has " + std::to_string(spec.state_size));
  if (!model.has_force())
    throw ModelError("model " + spec.model + ": has no force function, forces cannot be computed");

  Traversal traversal(grid, options.max_sub_steps);
  SafetyCore safety({.max_force = options.max_force});
  // A paced run must not write before its end, so all its ticks find room; without deadlines the
  // sink writes whenever the storage is full.
  const bool paced = options.rate_hz > 0;
  constexpr std::size_t kChunk = 4096;
  std::optional<Log> log;
  if (!options.log.empty())
    log.emplace(options.log, spec.state_size, paced ? options.rate_hz : kUnpacedHz,
                paced ? device.size() : std::min(device.size(), kChunk));

  const auto force = [&](const Vec3& x, std::span<const double> s) {
    return model.force(x, s.data());
  };
  const auto sink = [&](const Tick& tick) {
    if (!log) return;
    if (log->full()) log->flush();
    log->add(tick);
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
  print_summary(summary, options.rate_hz);
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
      "cells, interpolates the state, computes the force with the grid's model and sends it.");
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
