#include <time.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/format.hpp"
#include "libcore/follow/paper_traversal.hpp"
#include "libcore/grid/grid.hpp"
#include "tools/common/signals.hpp"
#include "tools/common/tool.hpp"
#include "tools/play/instead.hpp"
#include "tools/play/report.hpp"

namespace hapgrid {

namespace {

// Loop and kernel take turns of this length, so that both meet the stalls of the machine.
constexpr double kTurnSeconds = 0.25;
// Time for each rate without --duration.
constexpr double kSeconds = 4;

/// A hand that circles in a box of one cell.
class NoDevice : public Device {
 public:
  explicit NoDevice(std::uint64_t ticks) : left_(ticks) {}
  DeviceInfo info() const override { return {.name = "none"}; }
  DeviceStatus read(DeviceInput& input) noexcept override {
    if (left_ == 0) return DeviceStatus::kEnd;
    const double t = static_cast<double>(left_--) * 1e-3;
    input.position = {0.5 + 0.4 * std::cos(t), 0.5 + 0.4 * std::sin(t), 0.5};
    return DeviceStatus::kOk;
  }
  DeviceStatus send(const Vec3&) noexcept override { return DeviceStatus::kOk; }
  DeviceStatus stop() noexcept override { return DeviceStatus::kOk; }
  std::string error() const override { return ""; }

 private:
  std::uint64_t left_;
};

/// A grid of eight points, each in the one state 0.
Grid one_cell() {
  GridSpec spec;
  spec.box = {{0, 0, 0}, 1, {2, 2, 2}};
  spec.state_size = 1;
  const Neighbourhood around(spec.box);
  RecordColumns columns;
  for (PointIndex p = 0; p < spec.box.points(); ++p) {
    columns.point.push_back(p);
    columns.level.push_back(0);
    columns.generation.push_back(0);
    columns.rows.push_back(0);
    for (int q = 0; q < kDirections; ++q)
      columns.links.push_back(around.inside(p) >> q & 1 ? Level{0} : kLeavesBox);
  }
  return Grid(spec, 1, columns);
}

/// How late clock_nanosleep() alone wakes up.
void measure_kernel(double rate_hz, std::uint64_t ticks, Histogram& lateness) {
  const std::int64_t start = monotonic_ns();
  for (std::uint64_t k = 1; k <= ticks && caught_signal.load() == 0; ++k) {
    std::int64_t due = start + static_cast<std::int64_t>(static_cast<double>(k) / rate_hz * 1e9);
    const timespec until{due / 1'000'000'000, due % 1'000'000'000};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR &&
           caught_signal.load() == 0) {
    }
    lateness.add(monotonic_ns() - due);
  }
}

struct Measured {
  Histogram loop, kernel, compute;
  std::uint64_t missed = 0;
};

void measure_loop(const Grid& grid, double rate_hz, double spin_us, std::uint64_t ticks,
                  Measured& measured) {
  NoDevice device(ticks);
  Mapping mapping({}, device.info(), grid.box());
  PaperTraversal traversal(grid);
  SafetyCore safety;
  std::atomic<std::uint64_t> heartbeat{0};
  const LoopSummary summary = run_loop(
      device, mapping, traversal, safety,
      [](const Traversal& t) {
        return Vec3{t.position()[0], t.position()[1], 0};
      },
      [](const Tick&) {}, caught_signal, heartbeat, {.rate_hz = rate_hz, .spin_us = spin_us});
  measured.loop.add(summary.lateness);
  measured.compute.add(summary.compute);
  measured.missed += summary.missed;
}

/// @return good, fair or poor
const char* grade(const Measured& m, double rate_hz) {
  const double period_ns = 1e9 / rate_hz;
  const auto part = [&](double p) {
    return static_cast<double>(m.loop.quantile(p) + m.compute.quantile(p)) / period_ns;
  };
  if (m.missed == 0 && part(0.999) <= 0.1) return "good";
  const double missed = static_cast<double>(m.missed) / static_cast<double>(m.loop.count());
  return missed <= 1e-3 && part(0.99) <= 0.25 ? "fair" : "poor";
}

}  // namespace

int run_selftest(const PlayOptions& options) {
  const double spin_us = changed({}, options.given).spin_us;
  const double seconds = options.duration_s > 0 ? options.duration_s : kSeconds;
  std::vector<double> rates{1000, 2000, 5000};
  if (options.rate_hz > 0) rates = {options.rate_hz};
  const Grid grid = one_cell();
  const CaughtSignals signals;
  std::printf(
      "# good: no tick missed, and 99.9 %% of them done within a tenth of the period\n"
      "# fair: at most one in 1000 missed, and 99 %% done within a quarter; else poor\n");
  for (const double rate_hz : rates) {
    Measured measured;
    std::string got;
    {
      const Realtime realtime(options.realtime.value_or(RealtimeMode::kTry));
      got = realtime.got();
      const int turns = std::max(1, static_cast<int>(seconds / (2 * kTurnSeconds)));
      const auto ticks = static_cast<std::uint64_t>(std::ceil(rate_hz * kTurnSeconds));
      for (int turn = 0; turn < turns && caught_signal.load() == 0; ++turn) {
        measure_loop(grid, rate_hz, spin_us, ticks, measured);
        measure_kernel(rate_hz, ticks, measured.kernel);
      }
    }
    if (caught_signal.load() != 0) return 128 + caught_signal.load();
    std::fputs(format("{:g} Hz: {} ({})\n"
                      "  the loop's lateness    {}; missed {} of {}\n"
                      "  the kernel's lateness  {}\n"
                      "  the loop's computing   {}\n",
                      rate_hz, grade(measured, rate_hz), got, quantiles_text(measured.loop),
                      measured.missed, measured.loop.count(), quantiles_text(measured.kernel),
                      quantiles_text(measured.compute))
                   .c_str(),
               stdout);
    std::fflush(stdout);
  }
  return kExitDone;
}

}  // namespace hapgrid
