// What HidDevice and its two threads share: the handles, the newest input and force, and the state
// of the device. hid_device.hpp lists what happens when something goes wrong.
#pragma once

#include <semaphore.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/triple_buffer.hpp"
#include "libcore/device/guard_process.hpp"
#include "libcore/device/hid_handle.hpp"
#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

using HidClock = std::chrono::steady_clock;  // CLOCK_MONOTONIC

/// Seconds as a duration from 0 to an hour; NaN gives 0.
HidClock::duration hid_duration(double seconds);

struct TimedInput {
  DeviceInput input;
  HidClock::time_point time;
};

struct TimedForce {
  Vec3 force{0, 0, 0};
  HidClock::time_point time;  // of send()
  std::uint64_t snaps = 0;    // so far
};

/// Wakes the writer. Posting takes no lock and never waits.
class HidBell {
 public:
  HidBell() { ::sem_init(&semaphore_, 0, 0); }
  ~HidBell() { ::sem_destroy(&semaphore_); }
  HidBell(const HidBell&) = delete;
  HidBell& operator=(const HidBell&) = delete;

  /// Rings once until the writer heard it, so that the count cannot overflow while the writer
  /// hangs.
  void ring() noexcept {
    if (!rung_.exchange(true, std::memory_order_acq_rel)) ::sem_post(&semaphore_);
  }
  /// Waits until it rings or the deadline is over.
  void wait(HidClock::time_point deadline) noexcept;

 private:
  sem_t semaphore_;
  std::atomic<bool> rung_{false};
};

enum class HidFault { kNone, kTold, kWriteHangs };

/// Public only for HidDevice and the threads.
struct HidShared {
  /// @throw DeviceError
  HidShared(const std::string& where, std::unique_ptr<HidProtocol> how)
      : path(where), protocol(std::move(how)), timing(protocol->timing()), out(open_wire(where)) {}

  const std::string path;
  const std::unique_ptr<HidProtocol> protocol;
  const HidTiming timing;
  std::shared_ptr<Heart> heart;        // null: nobody looks at it
  const std::unique_ptr<HidWire> out;  // the writer's
  // The reader's. It is opened after the device was started: for a handle that nobody reads, the
  // kernel keeps the oldest reports, and the first position must not be an old one.
  std::unique_ptr<HidWire> in;

  TripleBuffer<TimedInput> input{TimedInput{}};
  TripleBuffer<TimedForce> force{TimedForce{}};
  HidBell bell;
  std::atomic<bool> stop{false};
  std::atomic<HidFault> fault{HidFault::kNone};
  std::atomic<HidClock::rep> writing_since{0};  // 0: not in hid_write()
  std::atomic<std::uint64_t> inputs{0}, rejected{0}, floods{0}, forces{0}, watchdog_zeros{0};

  // The haptic thread never uses what follows.
  std::mutex mutex;
  std::condition_variable changed;
  std::string error;
  std::string odd_report;  // the first report that was rejected, in words
  bool first_input = false, reader_done = false, writer_done = false;
  bool let_go = false;  // the device took zero force and stop reports

  void read_loop();
  void write_loop();
  /// The user is told the first fault.
  void tell_fault(const std::string& what);
  template <class Change>
  void change(Change&& what) {
    {
      const std::lock_guard lock(mutex);
      what();
    }
    changed.notify_all();
  }

 private:
  /// Shows the guard that the program lives. @return false when the guard let go of the device
  bool beat();
  bool write(const HidReport& report);
  bool write_all(const std::vector<HidReport>& reports);
  bool write_force(const Vec3& value, std::vector<HidReport>& reports);
  /// Writes zero force and the stop reports. @return whether the device took them all
  bool write_stop(std::vector<HidReport>& reports);
  void write_forces(std::vector<HidReport>& reports);
};

}  // namespace hapgrid
