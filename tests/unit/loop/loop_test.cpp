#include "libcore/loop/loop.hpp"

#include <stdexcept>

#include "libcore/follow/paper_traversal.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/follow/random_grid.hpp"
#include "tests/unit/loop/limits.hpp"

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
  std::size_t begin_at = ~std::size_t{0};  // another hand
  std::vector<Vec3> sent;                  // reserved: a tick must not allocate

  explicit FakeDevice(std::size_t count = 0) {
    for (std::size_t i = 0; i < count; ++i) {
      const double t = static_cast<double>(i);
      path.push_back({1.5 + std::sin(t / 10), 1.5 + std::cos(t / 7), 1.5});
    }
    sent.reserve(count + 100);
  }

  DeviceInfo info() const override { return {.name = "fake"}; }
  Status read(DeviceInput& input) noexcept override {
    if (next == fail_read_at) return Status::kFailed;
    if (next == path.size()) return Status::kEnd;
    input.begins = next == begin_at;
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

/// What is sent is what was computed.
const SafetyLimits kClampOnly = [] {
  SafetyLimits limits = only_clamp(3);
  limits.reserve = kInf;
  return limits;
}();

struct Fixture {
  Grid grid = random_grid({{0, 0, 0}, 1, {4, 4, 4}}, 2, 2, 1);
  PaperTraversal traversal{grid};
  SafetyCore safety{kClampOnly};
  std::atomic<int> stop{0};
  std::atomic<std::uint64_t> heartbeat{0};

  template <class Force, class Sink>
  LoopSummary loop(FakeDevice& d, Force&& force, Sink&& sink, const LoopOptions& options = {}) {
    Mapping mapping({}, d.info(), grid.box());
    return run_loop(d, mapping, traversal, safety, force, sink, stop, heartbeat, options);
  }
};

constexpr auto kConstant = [](const Traversal&) { return Vec3{1, 2, 0.5}; };
constexpr auto kIgnore = [](const Tick&) {};

}  // namespace

TEST_CASE_METHOD(Fixture, "each position gives a force, and a zero force ends the loop") {
  FakeDevice d(100);
  d.path[50] = {-9, 1.5, 1.5};
  std::vector<double> states;
  std::size_t ticks = 0;
  const auto force = [&](const Traversal& t) {
    CHECK(t.position() == (ticks == 50 ? Vec3{0, 1.5, 1.5} : d.path[ticks]));  // held in the box
    return Vec3{t.state()[0], t.state()[1], 0};
  };
  const LoopSummary summary = loop(d, force, [&](const Tick& tick) {
    CHECK(tick.number == ticks);
    CHECK(tick.hip == d.path[ticks]);
    CHECK(tick.force.force == d.sent.back());
    CHECK(d.sent.back() == Vec3{tick.traversal.state()[0], tick.traversal.state()[1], 0});
    CHECK(tick.step.outside == (ticks == 50));
    ++ticks;
  });
  CHECK(ticks == 100);
  CHECK(summary.ticks == 100);
  CHECK(summary.outside == 1);
  CHECK(summary.end == LoopExit::kDeviceEnd);
  CHECK(summary.zero_sent);
  CHECK(summary.missed == 0);
  CHECK(heartbeat == 101);  // the last beat met the end of the device
  CHECK(d.sent.size() == 101);
  CHECK(d.sent.back() == kZero);
}

TEST_CASE_METHOD(Fixture, "the stop flag ends the loop with a zero force") {
  const auto sink = [&](const Tick& tick) {
    if (tick.number >= 9) stop = 15;  // paced, tick 9 can be one that is missed
  };
  for (const double rate : {0.0, 10000.0}) {
    stop = 0;
    FakeDevice d(100);
    const LoopSummary summary = loop(d, kConstant, sink, {.rate_hz = rate});
    CHECK(summary.end == LoopExit::kStopped);
    CHECK(summary.ticks <= 10);
    CHECK(summary.zero_sent);
    CHECK(d.sent.back() == kZero);
    CHECK(d.sent.size() == summary.ticks + 1);
  }
  // Set before the first tick: nothing but the zero is ever sent.
  FakeDevice d(100);
  stop = 2;
  CHECK(loop(d, kConstant, kIgnore).ticks == 0);
  CHECK(d.sent == std::vector<Vec3>{kZero});
}

TEST_CASE_METHOD(Fixture, "a device that fails is left with a zero force, or it is said") {
  const bool reading = GENERATE(true, false);
  FakeDevice d(100);
  (reading ? d.fail_read_at : d.fail_send_at) = 5;
  LoopSummary summary = loop(d, kConstant, kIgnore);
  CHECK(summary.end == LoopExit::kDeviceFailed);
  CHECK(summary.ticks == 5);
  CHECK(summary.zero_sent);
  CHECK(d.sent.size() == (reading ? 6 : 7));
  CHECK(d.sent.back() == kZero);

  FakeDevice short_one(5);
  short_one.fail_send_at = 5;  // the last zero itself
  summary = loop(short_one, kConstant, kIgnore);
  CHECK(summary.end == LoopExit::kDeviceEnd);
  CHECK_FALSE(summary.zero_sent);
}

TEST_CASE_METHOD(Fixture, "an exception in force or sink leaves a zero force behind") {
  FakeDevice d(100);
  const bool in_force = GENERATE(true, false);
  const auto force = [&](const Traversal&) -> Vec3 {
    if (in_force && d.sent.size() == 7) throw std::runtime_error("force");
    return {1, 1, 1};
  };
  const auto sink = [&](const Tick& tick) {
    if (!in_force && tick.number == 6) throw std::runtime_error("sink");
  };
  CHECK_THROWS_WITH(loop(d, force, sink), in_force ? "force" : "sink");
  CHECK(d.sent.size() == 8);
  CHECK(d.sent.back() == kZero);
}

TEST_CASE_METHOD(Fixture, "what is not finite makes all later forces zero") {
  FakeDevice d(100);
  const bool is_force = GENERATE(true, false);
  if (!is_force) d.path[40][1] = std::nan("");
  const auto force = [&](const Traversal&) {
    return is_force && d.sent.size() == 40 ? Vec3{1, std::nan(""), 1} : Vec3{1, 2, 0.5};
  };
  const LoopSummary summary = loop(d, force, kIgnore);
  CHECK(summary.not_finite == !is_force);
  CHECK(summary.count_of(kFault) == 60);
  for (std::size_t i = 0; i < d.sent.size(); ++i)
    CHECK(d.sent[i] == (i < 40 ? Vec3{1, 2, 0.5} : kZero));
}

TEST_CASE_METHOD(Fixture, "a paced loop keeps absolute deadlines and skips what it misses") {
  // Only lower bounds: a virtual machine can stall at any time.
  FakeDevice d(200);
  std::uint64_t last = 0;
  const std::int64_t begin = monotonic_ns();
  const auto sink = [&](const Tick& tick) {
    if (tick.number > 0) CHECK(tick.number > last);
    last = tick.number;
    // Tick k is never before start + k / rate.
    CHECK(monotonic_ns() - begin >= 1'000'000 * static_cast<std::int64_t>(last));
    if (d.sent.size() == 100) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  };
  const LoopSummary summary = loop(d, kConstant, sink, {.rate_hz = 1000});
  CHECK(summary.ticks == 200);
  CHECK(summary.missed >= 9);
  CHECK(last == 199 + summary.missed);  // each missed tick is skipped, none is run late
  CHECK(d.sent.back() == kZero);
}

TEST_CASE_METHOD(Fixture, "a tick allocates nothing") {
  FakeDevice d(5000);
  d.path[1000] = {90, 90, 90};
  std::uint64_t before = 0, after = 0;
  const auto sink = [&](const Tick& tick) {
    if (tick.number == 0) before = allocations();
    after = allocations();
  };
  loop(d, kConstant, sink, {.rate_hz = 100000});
  CHECK(after == before);
  CHECK(before > 0);
}

namespace {

/// A handle in metres that says what a test tells it to.
struct HeldDevice : FakeDevice {
  std::vector<DeviceInput> inputs;
  DeviceInfo info() const override {
    return {.name = "held",
            .unit = DeviceInfo::Unit::kMetres,
            .low = {-0.1, -0.1, -0.1},
            .high = {0.1, 0.1, 0.1}};
  }
  Status read(DeviceInput& input) noexcept override {
    if (next == inputs.size()) return Status::kEnd;
    input = inputs[next++];
    return Status::kOk;
  }
};

}  // namespace

TEST_CASE_METHOD(Fixture, "a stalled device is let go; the HIP is not moved by the clutch") {
  HeldDevice d;
  for (int i = 0; i < 40; ++i)
    d.inputs.push_back(
        {.position = {i * 0.001, 0, 0}, .stalled = i >= 10 && i < 20, .clutch = i >= 25 && i < 30});
  std::vector<double> x;
  const LoopSummary summary =
      loop(d, kConstant, [&](const Tick& tick) { x.push_back(tick.hip[0]); });
  CHECK(summary.count_of(kStalled) == 10);
  CHECK(summary.count_of(kClutched) == 5);
  // 0.2 m of reach fill the box of 3: 0.015 a millimetre, from the middle.
  for (int i = 0; i < 25; ++i) CHECK(x[i] == Approx(1.5 + 0.015 * i));
  for (int i = 25; i < 30; ++i) CHECK(x[i] == x[24]);
  for (int i = 31; i < 40; ++i) CHECK(x[i] == Approx(x[24] + 0.015 * (i - 30)));
  for (int i = 10; i < 20; ++i) CHECK(d.sent[i] == kZero);
  CHECK(d.sent[24] == Vec3{1, 2, 0.5});
}

TEST_CASE_METHOD(Fixture, "a fault ends with the user's reset, a press after it") {
  HeldDevice d;
  // By a button, by the clutch, or by a button that is held from before the fault on.
  const std::string by = GENERATE(as<std::string>{}, "button", "clutch", "held");
  const auto pressed = [&](int i) { return by == "held" ? i >= 5 && i != 20 : i == 5 || i == 20; };
  for (int i = 0; i < 30; ++i)
    d.inputs.push_back(
        {.clutch = pressed(i) && by == "clutch", .reset = pressed(i) && by != "clutch"});
  int ticks = 0, asked = 0;
  const auto force = [&](const Traversal&) {
    ++asked;
    return ticks == 10 ? Vec3{std::nan(""), 0, 0} : Vec3{1, 0, 0};
  };
  loop(d, force, [&](const Tick&) { ++ticks; });
  CHECK(asked == 30);  // a force that depends on the steps before misses none of them
  for (int i = 0; i < 30; ++i) {
    const bool is_let_go = by == "clutch" && pressed(i);  // no force then either
    const bool works = i < 10 || i >= (by == "held" ? 21 : 20);
    CHECK(d.sent[i] == (works && !is_let_go ? Vec3{1, 0, 0} : kZero));
  }
}

TEST_CASE_METHOD(Fixture,
                 "a press of the button takes the next level, whose force comes by the ramp") {
  HeldDevice d;
  PointIndex two = 0;  // a point with two levels
  while (grid.levels(two) < 2) ++two;
  const Vec3 at = grid.box().position(two);
  const Vec3 place{(at[0] - 1.5) / 15, (at[1] - 1.5) / 15, (at[2] - 1.5) / 15};
  for (int i = 0; i < 60; ++i)
    d.inputs.push_back({.position = place, .next = (i >= 20 && i < 25) || i == 40});
  safety = SafetyCore({.slew = kInf, .ramp_ms = 10, .reserve = kInf});
  std::vector<std::uint64_t> chosen;
  loop(d, kConstant, [&](const Tick& tick) {
    if (tick.step.chosen != kNoLevel) chosen.push_back(tick.number);
    CHECK(tick.step.snapped == (tick.step.chosen != kNoLevel));
  });
  CHECK(chosen == std::vector<std::uint64_t>{20, 40});
  // A ramp of ten ticks from each of them on.
  for (int i = 0; i < 60; ++i)
    CHECK(d.sent[i][0] == Approx(std::min(1.0, (i % 20 + 1) / 10.0)).epsilon(1e-9));
}

TEST_CASE_METHOD(Fixture, "a replay's missed ticks count as time and in the numbers") {
  HeldDevice d;
  for (int i = 0; i < 10; ++i) d.inputs.push_back({.missed = i == 4 ? 7U : 0U});
  safety = SafetyCore({.slew = 0.1, .ramp_ms = 0, .reserve = kInf});
  std::vector<std::uint64_t> numbers;
  const auto force = [](const Traversal&) { return Vec3{3, 0, 0}; };
  const auto sink = [&](const Tick& tick) { numbers.push_back(tick.number); };
  const LoopSummary summary = loop(d, force, sink);
  CHECK(numbers == std::vector<std::uint64_t>{0, 1, 2, 3, 11, 12, 13, 14, 15, 16});
  CHECK(summary.missed == 7);
  CHECK(summary.overruns == 1);
  CHECK(d.sent[3][0] == Approx(0.4));
  CHECK(d.sent[4][0] == Approx(1.2));  // 8 ms at 0.1 N/ms
}

namespace {

/// A time that passes while the loop waits, and as a test tells it to.
struct VirtualClock : Clock {
  std::int64_t ns = 1'000'000;
  std::int64_t now() noexcept override { return ns; }
  void sleep_until(std::int64_t until) noexcept override { ns = std::max(ns, until); }
};

/// Answers late, and writes down when it was sent which force.
struct LateDevice : FakeDevice {
  VirtualClock clock;
  std::vector<std::pair<std::int64_t, Vec3>> taken;
  std::function<std::int64_t(std::size_t)> read_late, send_late;  // by the tick
  explicit LateDevice(std::size_t count) : FakeDevice(count) {}
  Status read(DeviceInput& input) noexcept override {
    clock.ns += read_late(next);
    return FakeDevice::read(input);
  }
  Status send(const Vec3& force) noexcept override {
    clock.ns += send_late(next) / 2;
    taken.emplace_back(clock.ns, force);
    clock.ns += send_late(next) / 2;
    return FakeDevice::send(force);
  }
};

}  // namespace

TEST_CASE_METHOD(Fixture, "forces change by the slew limit in wall time, however late a tick is") {
  const std::string kind = GENERATE(as<std::string>{}, "punctual", "once", "random", "long");
  constexpr std::size_t kTicks = 20000;
  LateDevice d(kTicks);
  std::mt19937_64 random(kTicks);
  const auto up_to = [&](double ms) {
    return static_cast<std::int64_t>(uniform(random, 0, ms) * 1e6);
  };
  d.read_late = [&](std::size_t tick) -> std::int64_t {
    if (kind == "once") return tick == 500 ? 8'500'000 : 10'000;
    if (kind == "random") return random() % 4 ? up_to(0.3) : up_to(10);
    if (kind == "long") return random() % 10 ? 20'000 : up_to(50);
    return 10'000;
  };
  d.send_late = [&](std::size_t) -> std::int64_t {
    return kind == "random" && random() % 8 == 0 ? up_to(3) : 5'000;
  };
  SafetyLimits limits = kClampOnly;
  limits.max_force = 10;
  limits.slew = 1;
  if (kind == "long") limits.watchdog_ticks = 10;
  safety = SafetyCore(limits);
  // It flips every 7 ticks, so that the slew limit always acts.
  std::size_t asked = 0;
  const auto flips = [&](const Traversal&) { return Vec3{asked++ / 7 % 2 ? 9.0 : -9.0, 0, 0}; };
  std::vector<bool> zero;
  loop(d, flips, [&](const Tick& tick) { zero.push_back((tick.force.acted & kSafetyZero) != 0); },
       {.rate_hz = 1000, .clock = &d.clock});
  REQUIRE(zero.size() == kTicks);
  double most = 0;
  for (std::size_t i = 1; i < kTicks; ++i) {
    if (zero[i]) continue;
    const double ms = static_cast<double>(d.taken[i].first - d.taken[i - 1].first) / 1e6;
    const double change = length_of(d.taken[i].second - d.taken[i - 1].second);
    REQUIRE(change <= limits.slew * ms + 1e-9);
    if (ms < 1.5) most = std::max(most, change);
  }
  CHECK(most > 0.9);  // a punctual loop may still use its millisecond
}

TEST_CASE_METHOD(Fixture, "where the hand begins anew, nothing of the ticks before counts") {
  // Ramp, slew and the speed guard all remember; a hole in the first hand's path is a fault.
  const auto sent = [&](std::size_t from) {
    FakeDevice d;
    const FakeDevice whole(400);
    d.path.assign(whole.path.begin() + static_cast<std::ptrdiff_t>(from), whole.path.end());
    if (from == 0) d.path[20][1] = std::nan("");
    d.begin_at = 100 - from;
    PaperTraversal afresh(grid);
    SafetyCore core({.ramp_ms = 150, .buzz_force = 0.01});
    Mapping mapping({.scale = 40}, d.info(), grid.box());
    const auto force = [](const Traversal& t) { return Vec3{t.state()[0], t.state()[1], 0}; };
    run_loop(d, mapping, afresh, core, force, kIgnore, stop, heartbeat);
    return std::vector<Vec3>(d.sent.end() - 301, d.sent.end());
  };
  const std::vector<Vec3> alone = sent(100);
  CHECK(sent(0) == alone);
  CHECK(std::any_of(alone.begin(), alone.end(), [](const Vec3& f) { return f != kZero; }));
}
