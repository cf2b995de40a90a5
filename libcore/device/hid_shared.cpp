#include "libcore/device/hid_shared.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <thread>
#include <utility>

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

constexpr int kReadMs = 50;  // the longest time until the reader sees that it must stop
constexpr int kDrain = 64;   // reports that hidraw queues
constexpr auto kAfterFlood = 250us;

}  // namespace

HidClock::duration hid_duration(double seconds) {
  const double bounded = seconds > 0 ? std::min(seconds, 3600.0) : 0;
  return std::chrono::duration_cast<HidClock::duration>(std::chrono::duration<double>(bounded));
}

void HidBell::wait(HidClock::time_point deadline) noexcept {
  const std::int64_t ns = std::max<std::int64_t>(deadline.time_since_epoch() / 1ns, 0);
  const timespec until{ns / 1'000'000'000, ns % 1'000'000'000};
  // An exchange, not a store, so that this thread sees what was published before the last ring. A
  // later ring posts again.
  if (::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until) == 0)
    rung_.exchange(false, std::memory_order_acq_rel);
}

void HidShared::tell_fault(const std::string& what) {
  change([&] {
    if (fault.load() != HidFault::kNone) return;
    error = path + ": " + what;
    auto none = HidFault::kNone;
    fault.compare_exchange_strong(none, HidFault::kTold);
  });
  bell.ring();  // the writer sends zero force
}

bool HidShared::write(const HidReport& report) {
  writing_since.store(HidClock::now().time_since_epoch().count());
  const bool took = out->try_write(report);
  writing_since.store(0);
  if (!took) tell_fault("write: " + out->error());
  return took;
}

bool HidShared::write_all(const std::vector<HidReport>& reports) {
  for (const HidReport& report : reports)
    if (!write(report)) return false;
  return true;
}

/// Tries every report, also after one that the device did not take: each may be an axis.
bool HidShared::write_force(const Vec3& value, std::vector<HidReport>& reports) {
  protocol->encode(value, reports);
  bool took = true;
  for (const HidReport& report : reports) took = write(report) && took;
  forces.fetch_add(1);
  return took;
}

bool HidShared::write_stop(std::vector<HidReport>& reports) {
  bool took = write_force({0, 0, 0}, reports);
  for (const HidReport& report : protocol->stop()) took = write(report) && took;
  return took;
}

void HidShared::read_loop() {
  std::array<std::uint8_t, kMaxHidReport + 1> buffer{};
  const std::size_t id = protocol->numbered() ? 0 : 1;  // bytes of the id that hidapi leaves out
  const std::span<std::uint8_t> room = std::span(buffer).subspan(id);
  DeviceInput newest;  // a report changes only what it contains
  bool told = false;
  while (!stop.load()) {
    bool fresh = false;
    int got = in->read(room, kReadMs);
    int drained = 0;
    while (got > 0) {
      const std::size_t size = static_cast<std::size_t>(got) + id;
      if (protocol->decode({buffer.data(), size}, newest)) {
        fresh = true;
        inputs.fetch_add(1);
      } else if (rejected.fetch_add(1) == 0) {
        change([&] {
          odd_report =
              "report " + std::to_string(buffer[0]) + " of " + std::to_string(got) + " bytes";
        });
      }
      if (++drained == kDrain) break;
      got = in->read(room, 0);
    }
    if (fresh) {
      input.back() = {newest, HidClock::now()};
      input.publish();
      if (!told) change([&] { first_input = told = true; });
    }
    if (got < 0) {
      tell_fault("read: " + in->error());
      break;
    }
    if (drained == kDrain) {
      floods.fetch_add(1);
      std::this_thread::sleep_for(kAfterFlood);
    }
  }
}

bool HidShared::beat() {
  if (!heart) return true;
  heart->beats.fetch_add(1);
  if (!heart->let_go.load()) return true;
  tell_fault("the program stood still, and its guard sent zero force");
  return false;
}

/// Runs until it must stop or the device fails.
void HidShared::write_forces(std::vector<HidReport>& reports) {
  const auto watchdog = hid_duration(timing.watchdog);
  const auto keep_alive = hid_duration(timing.keep_alive);
  const auto rest = hid_duration(timing.rest);
  const std::vector<HidReport> alive = protocol->keep_alive(), snap = protocol->snap();
  TimedForce now_applied;
  std::uint64_t snaps = 0;
  bool idle = true;  // zero force by the watchdog, or none came yet
  auto repeat = HidClock::now() + keep_alive;
  while (!stop.load() && fault.load() == HidFault::kNone) {
    auto deadline = HidClock::now() + 1h;
    if (!idle && watchdog > 0s) deadline = std::min(deadline, now_applied.time + watchdog);
    if (keep_alive > 0s) deadline = std::min(deadline, repeat);
    if (heart) deadline = std::min(deadline, HidClock::now() + kHeartBeat);
    bell.wait(deadline);
    if (stop.load() || !beat()) return;
    bool due = force.update();
    if (due) {
      now_applied = force.front();
      idle = false;
    }
    // This holds also for a new force that waited while a write hung.
    if (!idle && watchdog > 0s && HidClock::now() - now_applied.time >= watchdog) {
      now_applied.force = {0, 0, 0};
      idle = due = true;
      watchdog_zeros.fetch_add(1);
    }
    const bool repeated = keep_alive > 0s && HidClock::now() >= repeat;
    if (repeated && !write_all(alive)) return;
    if (std::exchange(snaps, now_applied.snaps) != now_applied.snaps && !write_all(snap)) return;
    if (due || (repeated && alive.empty())) {
      if (!write_force(now_applied.force, reports)) return;
      if (rest > 0s) std::this_thread::sleep_for(rest);
    }
    if (repeated || (due && alive.empty())) repeat = HidClock::now() + keep_alive;
  }
}

void HidShared::write_loop() {
  std::vector<HidReport> reports;
  // What the first call allocates must not hold up the loop's first tick.
  protocol->encode({0, 0, 0}, reports);
  write_forces(reports);
  bool took = write_stop(reports);
  if (!took && !stop.load()) {
    // A failure is not always the end of the device: try once more when the loop stops it.
    while (!stop.load()) bell.wait(HidClock::now() + 1h);
    took = write_stop(reports);
  }
  change([&] { let_go = took; });
}

}  // namespace hapgrid
