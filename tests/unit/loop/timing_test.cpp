// Histogram, pacer, watchdog and real time.
#include <sys/resource.h>

#include "libcore/base/histogram.hpp"
#include "libcore/loop/pacer.hpp"
#include "libcore/loop/realtime.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/follow/random_grid.hpp"

using namespace hapgrid;
using hapgrid::testing::uniform;

TEST_CASE("a histogram's quantiles are those of the sorted values, within a bin of 1/128") {
  std::mt19937_64 random(3);
  Histogram histogram;
  std::vector<std::int64_t> values;
  for (int i = 0; i < 20000; ++i) {
    const auto value = static_cast<std::int64_t>(std::exp(uniform(random, 0, 30)));
    values.push_back(value);
    histogram.add(value);
  }
  std::sort(values.begin(), values.end());
  for (const double p : {0.001, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const std::int64_t exact = values[static_cast<std::size_t>(std::ceil(p * 20000)) - 1];
    CHECK(histogram.quantile(p) >= exact);
    CHECK(static_cast<double>(histogram.quantile(p)) <= static_cast<double>(exact) * 129 / 128);
  }
  CHECK(histogram.max() == values.back());
  CHECK(histogram.quantile(1) == values.back());
  std::uint64_t count = 0;
  std::int64_t last = 0;
  histogram.for_each_bin([&](std::int64_t from, std::int64_t to, std::uint64_t in_bin) {
    CHECK(from >= last);
    last = to;
    count += in_bin;
    const auto within = std::upper_bound(values.begin(), values.end(), to - 1) -
                        std::lower_bound(values.begin(), values.end(), from);
    CHECK(static_cast<std::uint64_t>(within) == in_bin);
  });
  CHECK(count == 20000);
}

TEST_CASE("the ends of a histogram") {
  Histogram histogram;
  CHECK(histogram.quantile(0.5) == 0);
  histogram.for_each_bin([](std::int64_t, std::int64_t, std::uint64_t) { FAIL("there is none"); });
  histogram.add(-5);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  CHECK(histogram.quantile(0.5) == 0);
  CHECK(histogram.quantile(1) == std::numeric_limits<std::int64_t>::max());
  Histogram sum;
  sum.add(histogram);
  sum.add(histogram);
  CHECK(sum.count() == 4);
}

TEST_CASE("a pacer that spins is never early, and tells how late it was") {
  const std::atomic<int> stop{0};
  for (const double spin_us : {0.0, 100.0}) {
    Clock clock;
    Pacer pacer(clock, 2000, spin_us);
    const std::int64_t before = monotonic_ns();
    pacer.wait(stop);
    for (int i = 0; i < 100; ++i) {
      const std::uint64_t number = pacer.wait(stop);
      // Its start lies behind `before`.
      CHECK(pacer.began_ns() - before >= static_cast<std::int64_t>(number) * 500'000);
      CHECK(pacer.lateness_ns() >= 0);
    }
  }
}

TEST_CASE("a pacer that is always late, or always waits awake, sleeps twice a second") {
  /// Each look at it takes its time.
  struct SlowClock : Clock {
    std::int64_t ns = 0, sleeps = 0, look_ns = 100;
    std::int64_t now() noexcept override { return ns += look_ns; }
    void sleep_until(std::int64_t until) noexcept override {
      ns = std::max(ns, until);
      ++sleeps;
    }
  };
  const std::atomic<int> stop{0};
  for (const bool late : {false, true}) {
    SlowClock clock;
    Pacer pacer(clock, 1000, late ? 0 : 1000);
    if (late) clock.look_ns = 1'500'000;
    pacer.wait(stop);
    while (clock.ns < 10'000'000'000) pacer.wait(stop);
    CHECK(clock.sleeps >= 19);
    CHECK(clock.sleeps <= 20);
  }
}

TEST_CASE("a watchdog barks once when the heart stops, and not while it beats") {
  std::atomic<std::uint64_t> heart{0};
  std::atomic<int> barks{0};
  using Clock = std::chrono::steady_clock;
  // Half a second of beats; once more where this machine stalled between two of them.
  constexpr auto kPatience = std::chrono::milliseconds(200);
  for (auto longest = Clock::duration::max(); longest >= kPatience;) {
    barks = 0;
    const auto watchdog = start_watchdog(heart, kPatience, [&] { ++barks; });
    longest = Clock::duration::zero();
    const auto begin = Clock::now();
    for (auto last = begin; last - begin < std::chrono::milliseconds(500);) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      ++heart;
      longest = std::max(longest, Clock::now() - last);
      last = Clock::now();
    }
  }
  CHECK(barks == 0);
  const auto watchdog = start_watchdog(heart, std::chrono::milliseconds(50), [&] { ++barks; });
  const auto begin = Clock::now();
  while (barks == 0 && Clock::now() - begin < std::chrono::seconds(20))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK(Clock::now() - begin >= std::chrono::milliseconds(50));
  CHECK(barks == 1);
}

namespace {

[[gnu::noinline]] void use_stack() {
  volatile char bytes[200 << 10];
  for (std::size_t i = 0; i < sizeof bytes; i += 512) bytes[i] = 0;
}

long page_faults() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt;
}

}  // namespace

TEST_CASE("the stack of the loop is in memory before the first tick") {
  const Realtime realtime(RealtimeMode::kTry);
  if (realtime.got().find("memory locked") == std::string::npos) {
    WARN(realtime.got());
    return;
  }
  const long before = page_faults();
  use_stack();
  CHECK(page_faults() == before);
}
