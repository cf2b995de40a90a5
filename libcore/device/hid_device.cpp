#include "libcore/device/hid_device.hpp"

#include <semaphore.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/signals.hpp"
#include "libcore/base/triple_buffer.hpp"
#include "libcore/device/hid_guard.hpp"
#include "libcore/device/hid_handle.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC

constexpr auto kFirstInput = 2s;
constexpr auto kStopWait = 1s;
constexpr auto kWriteLimit = 500ms;
constexpr int kReadMs = 50;  // how soon the reader sees that it is to stop
constexpr int kDrain = 64;   // what hidraw queues
constexpr auto kAfterFlood = 250us;

Clock::duration seconds(double value) {
  const double bounded = value > 0 ? std::min(value, 3600.0) : 0;  // 0 for NaN, too
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(bounded));
}

struct TimedInput {
  DeviceInput input;
  Clock::time_point time;
};

struct TimedForce {
  Vec3 force{0, 0, 0};
  Clock::time_point time;  // of send()
};

/// Wakes the writer. Posting takes no lock and never waits.
class Bell {
 public:
  Bell() { ::sem_init(&semaphore_, 0, 0); }
  ~Bell() { ::sem_destroy(&semaphore_); }
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;

  /// Once is enough until it is heard: the count cannot run over behind a writer that hangs.
  void ring() noexcept {
    if (!rung_.exchange(true, std::memory_order_acq_rel)) ::sem_post(&semaphore_);
  }
  /// Until it rings or the deadline is over.
  void wait(Clock::time_point deadline) noexcept {
    const std::int64_t ns = std::max<std::int64_t>(deadline.time_since_epoch() / 1ns, 0);
    const timespec until{ns / 1'000'000'000, ns % 1'000'000'000};
    // An exchange and no store: it sees what was published before the last ring that it takes back.
    // Whoever rings later posts again.
    if (::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until) == 0)
      rung_.exchange(false, std::memory_order_acq_rel);
  }

 private:
  sem_t semaphore_;
  std::atomic<bool> rung_{false};
};

enum class Fault { kNone, kTold, kWriteHangs };

}  // namespace

struct HidDevice::Shared {
  Shared(const std::string& where, std::unique_ptr<HidProtocol> how)
      : path(where), protocol(std::move(how)), in(where), out(where), timing(protocol->timing()) {}

  const std::string path;
  const std::unique_ptr<HidProtocol> protocol;
  HidHandle in, out;  // the reader's, the writer's
  const HidTiming timing;

  TripleBuffer<TimedInput> input{TimedInput{}};
  TripleBuffer<TimedForce> force{TimedForce{}};
  Bell bell;
  std::atomic<bool> stop{false};
  std::atomic<Fault> fault{Fault::kNone};
  std::atomic<Clock::rep> writing_since{0};  // 0: not in hid_write()
  std::atomic<std::uint64_t> inputs{0}, rejected{0}, floods{0}, forces{0}, watchdog_zeros{0};

  // Never the haptic thread's.
  std::mutex mutex;
  std::condition_variable changed;
  std::string error;
  std::string odd_report;  // the last one that was no input, in words
  bool first_input = false, reader_done = false, writer_done = false;
  bool let_go = false;  // the device took zero force and stop reports

  void tell_fault(const std::string& what);
  bool write(const HidReport& report);
  bool write_force(const Vec3& value, std::vector<HidReport>& reports);
  bool write_stop(std::vector<HidReport>& reports);
  void write_forces(std::vector<HidReport>& reports);
  void read_loop();
  void write_loop();
  template <class Change>
  void change(Change&& what) {
    {
      const std::lock_guard lock(mutex);
      what();
    }
    changed.notify_all();
  }
};

/// The first one is what the user hears about.
void HidDevice::Shared::tell_fault(const std::string& what) {
  change([&] {
    if (fault.load() != Fault::kNone) return;
    error = path + ": " + what;
    auto none = Fault::kNone;
    fault.compare_exchange_strong(none, Fault::kTold);
  });
  bell.ring();  // the writer lets go
}

bool HidDevice::Shared::write(const HidReport& report) {
  writing_since.store(Clock::now().time_since_epoch().count());
  const bool took = out.try_write(report);
  writing_since.store(0);
  if (!took) tell_fault("write: " + out.error());
  return took;
}

/// Every report is tried, also behind one that was not taken: they may be an axis each.
bool HidDevice::Shared::write_force(const Vec3& value, std::vector<HidReport>& reports) {
  protocol->encode(value, reports);
  bool took = true;
  for (const HidReport& report : reports) took = write(report) && took;
  forces.fetch_add(1);
  return took;
}

bool HidDevice::Shared::write_stop(std::vector<HidReport>& reports) {
  bool took = write_force({0, 0, 0}, reports);
  for (const HidReport& report : protocol->stop()) took = write(report) && took;
  return took;
}

void HidDevice::Shared::read_loop() {
  std::array<std::uint8_t, kMaxHidReport + 1> buffer{};
  const std::size_t id = protocol->numbered() ? 0 : 1;  // bytes that hidapi leaves out
  const std::span<std::uint8_t> room = std::span(buffer).subspan(id);
  DeviceInput newest;  // what a report does not speak of stays
  bool told = false;
  while (!stop.load()) {
    bool fresh = false;
    int got = in.read(room, kReadMs);
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
      got = in.read(room, 0);
    }
    if (fresh) {
      input.back() = {newest, Clock::now()};
      input.publish();
      if (!told) change([&] { first_input = told = true; });
    }
    if (got < 0) {
      tell_fault("read: " + in.error());
      break;
    }
    if (drained == kDrain) {
      floods.fetch_add(1);
      std::this_thread::sleep_for(kAfterFlood);
    }
  }
}

/// Until it is to stop, or the device fails.
void HidDevice::Shared::write_forces(std::vector<HidReport>& reports) {
  const auto watchdog = seconds(timing.watchdog);
  const auto keep_alive = seconds(timing.keep_alive);
  const std::vector<HidReport> alive = protocol->keep_alive();
  TimedForce now_applied;
  bool idle = true;  // zero force by the watchdog, or none came yet
  auto repeat = Clock::now() + keep_alive;
  while (!stop.load() && fault.load() == Fault::kNone) {
    auto deadline = Clock::now() + 1h;
    if (!idle && watchdog > 0s) deadline = std::min(deadline, now_applied.time + watchdog);
    if (keep_alive > 0s) deadline = std::min(deadline, repeat);
    bell.wait(deadline);
    if (stop.load()) return;
    bool due = force.update();
    if (due) {
      now_applied = force.front();
      idle = false;
    }
    // Also a force that is new but waited behind a write that hung.
    if (!idle && watchdog > 0s && Clock::now() - now_applied.time >= watchdog) {
      now_applied.force = {0, 0, 0};
      idle = due = true;
      watchdog_zeros.fetch_add(1);
    }
    const bool repeated = keep_alive > 0s && Clock::now() >= repeat;
    if (repeated)
      for (const HidReport& report : alive)
        if (!write(report)) return;
    if (due || (repeated && alive.empty()))
      if (!write_force(now_applied.force, reports)) return;
    if (repeated || (due && alive.empty())) repeat = Clock::now() + keep_alive;
  }
}

void HidDevice::Shared::write_loop() {
  std::vector<HidReport> reports;
  write_forces(reports);
  bool took = write_stop(reports);
  if (!took && !stop.load()) {
    // A failure is not always the end of the device: once more, when it is said to be stopped.
    while (!stop.load()) bell.wait(Clock::now() + 1h);
    took = write_stop(reports);
  }
  change([&] { let_go = took; });
}

HidDevice::HidDevice(const std::string& path, std::unique_ptr<HidProtocol> protocol,
                     HidGuard* guard)
    : info_(protocol->info()),
      shared_(std::make_shared<Shared>(path, std::move(protocol))),
      guard_(guard) {
  Shared& s = *shared_;
  if (guard_) guard_->watch(path, s.protocol->stop());
  try {
    s.protocol->start(s.out);
    if (guard_) guard_->watch(path, s.protocol->stop());
    start_threads();
    if (s.timing.stall <= 0) return;
    std::unique_lock lock(s.mutex);
    const bool heard = s.changed.wait_for(
        lock, kFirstInput, [&s] { return s.first_input || s.fault.load() != Fault::kNone; });
    if (s.first_input) return;
    if (heard) throw DeviceError(s.error);
    const std::uint64_t rejected = s.rejected.load();
    throw DeviceError(path + ": no input within " + std::to_string(kFirstInput / 1s) + " s" +
                      (rejected == 0 ? ": the device sent no report"
                                     : ": " + std::to_string(rejected) +
                                           " reports that are not its input, the first one was " +
                                           s.odd_report));
  } catch (...) {
    stop();
    throw;
  }
}

HidDevice::~HidDevice() { stop(); }

void HidDevice::start_threads() {
  const BlockedSignals blocked;
  // They own what they use. What they throw is memory that is missing, and a fault like another.
  const auto body = [](std::shared_ptr<Shared> shared, void (Shared::*loop)(), bool Shared::*done) {
    try {
      (*shared.*loop)();
    } catch (const std::exception& e) {
      shared->tell_fault(e.what());
    }
    shared->change([&] { (*shared).*done = true; });
  };
  writer_ = std::thread(body, shared_, &Shared::write_loop, &Shared::writer_done);
  reader_ = std::thread(body, shared_, &Shared::read_loop, &Shared::reader_done);
}

DeviceStatus HidDevice::read(DeviceInput& input) noexcept {
  Shared& s = *shared_;
  if (s.fault.load(std::memory_order_acquire) != Fault::kNone) return DeviceStatus::kFailed;
  s.input.update();
  input = s.input.front().input;
  input.stalled =
      s.timing.stall > 0 && Clock::now() - s.input.front().time > seconds(s.timing.stall);
  return DeviceStatus::kOk;
}

DeviceStatus HidDevice::send(const Vec3& force) noexcept {
  if (stopped_) return stop_status_;
  Shared& s = *shared_;
  const auto now = Clock::now();
  const auto since = Clock::time_point(Clock::duration(s.writing_since.load()));
  if (since != Clock::time_point() && now - since > kWriteLimit) {
    auto none = Fault::kNone;
    s.fault.compare_exchange_strong(none, Fault::kWriteHangs);
    s.bell.ring();  // should the write have ended just now
  }
  if (s.fault.load(std::memory_order_acquire) != Fault::kNone) return DeviceStatus::kFailed;
  s.force.back() = {force, now};
  s.force.publish();
  s.bell.ring();
  return DeviceStatus::kOk;
}

DeviceStatus HidDevice::stop() noexcept {
  if (stopped_) return stop_status_;
  stopped_ = true;
  Shared& s = *shared_;
  s.stop.store(true);
  s.bell.ring();
  std::vector<HidReport> reports;
  if (!writer_.joinable()) {
    // The constructor failed before there was a writer.
    s.let_go = s.write_stop(reports);
  } else {
    std::unique_lock lock(s.mutex);
    s.changed.wait_for(lock, kStopWait, [&s] { return s.writer_done && s.reader_done; });
    const bool writer_done = s.writer_done, reader_done = s.reader_done;
    lock.unlock();
    if (writer_done) {
      writer_.join();
    } else {
      s.tell_fault("stop: the device did not take the zero force within " +
                   std::to_string(kStopWait / 1s) + " s");
      writer_.detach();
    }
    if (reader_.joinable()) {
      if (reader_done) {
        reader_.join();
      } else {
        reader_.detach();
      }
    }
  }
  const std::lock_guard lock(s.mutex);
  stop_status_ = s.let_go ? DeviceStatus::kOk : DeviceStatus::kFailed;
  if (s.let_go && guard_) guard_->release();
  return stop_status_;
}

std::string HidDevice::error() const {
  Shared& s = *shared_;
  const std::lock_guard lock(s.mutex);
  if (s.fault.load() == Fault::kWriteHangs)
    return s.path + ": write: the device did not take a report within " +
           std::to_string(kWriteLimit / 1ms) + " ms";
  return s.error;
}

HidCounts HidDevice::counts() const noexcept {
  const Shared& s = *shared_;
  return {s.inputs.load(), s.rejected.load(), s.floods.load(), s.forces.load(),
          s.watchdog_zeros.load()};
}

}  // namespace hapgrid
