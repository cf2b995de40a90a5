#include "libcore/haptic/loop.hpp"

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/unit/haptic/count_allocations.hpp"
#include "tests/unit/haptic/random_grid.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;

namespace {

/// A device that misbehaves on command, and remembers.
struct FakeDevice : Device {
  using Status = DeviceStatus;

  std::vector<Vec3> path;
  std::size_t next = 0;
  std::size_t fail_read_at = ~std::size_t{0};
  std::size_t fail_send_at = ~std::size_t{0};
  std::vector<Vec3> sent;  // reserved by device(): a tick must not allocate

  FakeDevice() = default;
  // Copied only to start afresh.
  FakeDevice(const FakeDevice& other) : Device(), path(other.path) {
    sent.reserve(path.size() + 2);
  }
  FakeDevice& operator=(const FakeDevice& other) {
    path = other.path;
    next = 0;
    fail_read_at = fail_send_at = ~std::size_t{0};
    sent.clear();
    return *this;
  }

  DeviceInfo info() const override { return {.name = "fake"}; }
  Status read(DeviceInput& input) noexcept override {
    if (next == fail_read_at) return Status::kFailed;
    if (next == path.size()) return Status::kEnd;
    input.position = path[next++];
    return Status::kOk;
  }
  Status send(const Vec3& force) noexcept override {
    const bool fails = sent.size() == fail_send_at;
    sent.push_back(force);
    return fails ? Status::kFailed : Status::kOk;
  }
  Status stop() noexcept override { return send({0, 0, 0}); }
  std::string error() const override { return "told to fail"; }
};

FakeDevice device(std::size_t count) {
  FakeDevice d;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i);
    d.path.push_back({1.5 + std::sin(t / 10), 1.5 + std::cos(t / 7), 1.5});
  }
  d.sent.reserve(count + 1);
  return d;
}

struct Fixture {
  Grid grid = random_grid({{0, 0, 0}, 1, {4, 4, 4}}, 2, 2, 1);
  Traversal traversal{grid};
  SafetyCore safety;
  std::atomic<int> stop{0};
};

constexpr auto kConstant = [](const Vec3&, std::span<const double>) { return Vec3{1, 2, 0.5}; };
constexpr auto kIgnore = [](const Tick&) {};
constexpr Vec3 kZero{0, 0, 0};

}  // namespace

TEST_CASE_METHOD(Fixture, "each position gives a force, and a zero force ends the loop") {
  FakeDevice d = device(100);
  d.path[50] = {-9, 1.5, 1.5};
  std::vector<double> states;
  std::size_t ticks = 0;
  const auto force = [&](const Vec3& x, std::span<const double> s) {
    CHECK(x == (ticks == 50 ? Vec3{0, 1.5, 1.5} : d.path[ticks]));  // held in the box
    return Vec3{s[0], s[1], 0};
  };
  const LoopSummary summary = run_loop(
      d, traversal, safety, force,
      [&](const Tick& tick) {
        CHECK(tick.number == ticks);
        CHECK(tick.hip == d.path[ticks]);
        CHECK(tick.force.force == d.sent.back());
        CHECK(d.sent.back() == Vec3{tick.traversal.state()[0], tick.traversal.state()[1], 0});
        CHECK(tick.step.outside == (ticks == 50));
        ++ticks;
      },
      stop);
  CHECK(ticks == 100);
  CHECK(summary.ticks == 100);
  CHECK(summary.outside == 1);
  CHECK(summary.end == LoopEnd::kDeviceEnd);
  CHECK(summary.zero_sent);
  CHECK(summary.missed == 0);
  CHECK(d.sent.size() == 101);
  CHECK(d.sent.back() == kZero);
}

TEST_CASE_METHOD(Fixture, "the stop flag ends the loop with a zero force") {
  FakeDevice d = device(100);
  const auto sink = [&](const Tick& tick) {
    if (tick.number >= 9) stop = 15;  // paced, tick 9 can be one that is missed
  };
  for (const double rate : {0.0, 10000.0}) {
    stop = 0;
    d = device(100);
    const LoopSummary summary = run_loop(d, traversal, safety, kConstant, sink, stop, rate);
    CHECK(summary.end == LoopEnd::kStopped);
    CHECK(summary.ticks <= 10);
    CHECK(summary.zero_sent);
    CHECK(d.sent.back() == kZero);
    CHECK(d.sent.size() == summary.ticks + 1);
  }
  // Set before the first tick: nothing but the zero is ever sent.
  d = device(100);
  stop = 2;
  CHECK(run_loop(d, traversal, safety, kConstant, kIgnore, stop).ticks == 0);
  CHECK(d.sent == std::vector<Vec3>{kZero});
}

TEST_CASE_METHOD(Fixture, "a device that fails is left with a zero force, or it is said") {
  FakeDevice d = device(100);
  d.fail_read_at = 5;
  LoopSummary summary = run_loop(d, traversal, safety, kConstant, kIgnore, stop);
  CHECK(summary.end == LoopEnd::kDeviceFailed);
  CHECK(summary.ticks == 5);
  CHECK(summary.zero_sent);
  CHECK(d.sent.back() == kZero);

  d = device(100);
  d.fail_send_at = 5;
  summary = run_loop(d, traversal, safety, kConstant, kIgnore, stop);
  CHECK(summary.end == LoopEnd::kDeviceFailed);
  CHECK(summary.ticks == 5);
  CHECK(summary.zero_sent);
  CHECK(d.sent.size() == 7);
  CHECK(d.sent.back() == kZero);

  d = device(5);
  d.fail_send_at = 5;  // the last zero itself
  summary = run_loop(d, traversal, safety, kConstant, kIgnore, stop);
  CHECK(summary.end == LoopEnd::kDeviceEnd);
  CHECK_FALSE(summary.zero_sent);
}

TEST_CASE_METHOD(Fixture, "an exception in force or sink leaves a zero force behind") {
  FakeDevice d = device(100);
  const auto throwing_force = [&](const Vec3&, std::span<const double>) -> Vec3 {
    if (d.sent.size() == 7) throw std::runtime_error("force");
    return {1, 1, 1};
  };
  CHECK_THROWS_WITH(run_loop(d, traversal, safety, throwing_force, kIgnore, stop), "force");
  CHECK(d.sent.size() == 8);
  CHECK(d.sent.back() == kZero);

  d = device(100);
  const auto throwing_sink = [](const Tick& tick) {
    if (tick.number == 3) throw std::runtime_error("sink");
  };
  CHECK_THROWS_WITH(run_loop(d, traversal, safety, kConstant, throwing_sink, stop), "sink");
  CHECK(d.sent.size() == 5);
  CHECK(d.sent.back() == kZero);
}

TEST_CASE_METHOD(Fixture, "what is not finite makes all later forces zero") {
  FakeDevice d = device(100);
  SECTION("the HIP") {
    d.path[40][1] = std::nan("");
    const LoopSummary summary = run_loop(d, traversal, safety, kConstant, kIgnore, stop);
    CHECK(summary.not_finite == 1);
    CHECK(summary.faulted == 60);
  }
  SECTION("the force") {
    const auto force = [&](const Vec3&, std::span<const double>) {
      return d.sent.size() == 40 ? Vec3{1, std::nan(""), 1} : Vec3{1, 2, 0.5};
    };
    const LoopSummary summary = run_loop(d, traversal, safety, force, kIgnore, stop);
    CHECK(summary.not_finite == 0);
    CHECK(summary.faulted == 60);
  }
  for (std::size_t i = 0; i < d.sent.size(); ++i)
    CHECK(d.sent[i] == (i < 40 ? Vec3{1, 2, 0.5} : kZero));
}

TEST_CASE_METHOD(Fixture, "a large force is limited and counted") {
  FakeDevice d = device(10);
  const auto force = [&](const Vec3&, std::span<const double>) { return Vec3{30, 0, -40}; };
  const LoopSummary summary = run_loop(d, traversal, safety, force, kIgnore, stop);
  CHECK(summary.clamped == 10);
  CHECK(d.sent[0][0] == Approx(3 * 0.6));
  CHECK(d.sent[0][2] == Approx(3 * -0.8));
}

TEST_CASE_METHOD(Fixture, "a paced loop keeps absolute deadlines and skips what it misses") {
  using Clock = std::chrono::steady_clock;
  // Only lower bounds: a virtual machine can stall at any time.
  FakeDevice d = device(200);
  std::uint64_t last = 0;
  const auto begin = Clock::now();
  const auto sink = [&](const Tick& tick) {
    if (tick.number > 0) CHECK(tick.number > last);
    last = tick.number;
    // Tick k is never before start + k / rate.
    CHECK(Clock::now() - begin >= std::chrono::milliseconds(last));
    if (d.sent.size() == 100) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  };
  const LoopSummary summary = run_loop(d, traversal, safety, kConstant, sink, stop, 1000);
  CHECK(summary.ticks == 200);
  CHECK(summary.missed >= 9);
  CHECK(last == 199 + summary.missed);  // each missed tick is skipped, none is run late
  CHECK(d.sent.back() == kZero);
}

TEST_CASE_METHOD(Fixture, "a tick allocates nothing") {
  FakeDevice d = device(5000);
  d.path[1000] = {90, 90, 90};
  std::uint64_t before = 0, after = 0;
  const auto sink = [&](const Tick& tick) {
    if (tick.number == 0) before = allocations();
    after = allocations();
  };
  run_loop(d, traversal, safety, kConstant, sink, stop, 100000);
  CHECK(after == before);
  CHECK(before > 0);
}
