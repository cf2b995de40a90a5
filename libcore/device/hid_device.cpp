#include "libcore/device/hid_device.hpp"

#include <pthread.h>
#include <sched.h>

#include <chrono>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/signals.hpp"
#include "libcore/device/hid_guard.hpp"
#include "libcore/device/hid_shared.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

constexpr auto kFirstInput = 2s;
constexpr auto kStopWait = 1s;
constexpr auto kWriteLimit = 500ms;

}  // namespace

HidDevice::HidDevice(const std::string& path, std::unique_ptr<HidProtocol> protocol,
                     HidGuard* guard)
    : info_(protocol->info()),
      shared_(std::make_shared<HidShared>(path, std::move(protocol))),
      guard_(guard) {
  HidShared& s = *shared_;
  if (guard_) {
    guard_->watch(path, s.protocol->stop());
    s.heart = guard_->heart();
  }
  try {
    s.protocol->start(*s.out);
    if (guard_) guard_->watch(path, s.protocol->stop());
    s.in = open_wire(path);
    writer_ = start_thread(&HidShared::write_loop, &HidShared::writer_done);
    reader_ = start_thread(&HidShared::read_loop, &HidShared::reader_done);
    if (s.timing.stall <= 0 && !s.timing.greets) return;
    std::unique_lock lock(s.mutex);
    const bool heard = s.changed.wait_for(
        lock, kFirstInput, [&s] { return s.first_input || s.fault.load() != HidFault::kNone; });
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

std::thread HidDevice::start_thread(void (HidShared::*loop)(), bool HidShared::*done) {
  const BlockedSignals blocked;
  // The thread shares what it uses. It throws only when memory is missing, which is a fault, too.
  return std::thread([shared = shared_, loop, done] {
    const bool reads = loop == &HidShared::read_loop;
    ::pthread_setname_np(::pthread_self(), reads ? "hid-reader" : "hid-writer");
    try {
      (*shared.*loop)();
    } catch (const std::exception& e) {
      shared->tell_fault(e.what());
    }
    shared->change([&] { (*shared).*done = true; });
  });
}

bool HidDevice::set_priority(int priority) noexcept {
  const sched_param wanted{.sched_priority = priority};
  bool took = true;
  for (std::thread* thread : {&reader_, &writer_})
    if (thread->joinable())
      took &= ::pthread_setschedparam(thread->native_handle(),
                                      priority > 0 ? SCHED_FIFO : SCHED_OTHER, &wanted) == 0;
  return took;
}

DeviceStatus HidDevice::read(DeviceInput& input) noexcept {
  HidShared& s = *shared_;
  if (s.fault.load(std::memory_order_acquire) != HidFault::kNone) return DeviceStatus::kFailed;
  s.input.update();
  input = s.input.front().input;
  input.stalled =
      s.timing.stall > 0 && HidClock::now() - s.input.front().time > hid_duration(s.timing.stall);
  return DeviceStatus::kOk;
}

DeviceStatus HidDevice::send(const Vec3& force) noexcept {
  if (stopped_) return stop_status_;
  HidShared& s = *shared_;
  const auto now = HidClock::now();
  const auto since = HidClock::time_point(HidClock::duration(s.writing_since.load()));
  if (since != HidClock::time_point() && now - since > kWriteLimit) {
    auto none = HidFault::kNone;
    s.fault.compare_exchange_strong(none, HidFault::kWriteHangs);
    s.bell.ring();  // in case the write has just ended
  }
  if (s.fault.load(std::memory_order_acquire) != HidFault::kNone) return DeviceStatus::kFailed;
  s.force.back() = {force, now, snaps_};
  s.force.publish();
  s.bell.ring();
  return DeviceStatus::kOk;
}

DeviceStatus HidDevice::stop() noexcept {
  if (stopped_) return stop_status_;
  stopped_ = true;
  HidShared& s = *shared_;
  s.stop.store(true);
  s.bell.ring();
  try {
    // When the constructor failed early there is no writer. This thread must not wait for hardware.
    if (!writer_.joinable())
      writer_ = start_thread(&HidShared::write_loop, &HidShared::writer_done);
  } catch (const std::exception&) {
    return stop_status_;
  }
  std::unique_lock lock(s.mutex);
  s.changed.wait_for(lock, kStopWait,
                     [&] { return s.writer_done && (s.reader_done || !reader_.joinable()); });
  const bool writer_done = s.writer_done, reader_done = s.reader_done, let_go = s.let_go;
  lock.unlock();
  if (!writer_done)
    s.tell_fault("stop: the device did not take the zero force within " +
                 std::to_string(kStopWait / 1s) + " s");
  const auto leave = [](std::thread& thread, bool done) {
    if (!thread.joinable()) return;
    if (done) {
      thread.join();
    } else {
      thread.detach();
    }
  };
  leave(writer_, writer_done);
  leave(reader_, reader_done);
  if (let_go && guard_) guard_->release();
  stop_status_ = let_go ? DeviceStatus::kOk : DeviceStatus::kFailed;
  return stop_status_;
}

std::string HidDevice::error() const {
  HidShared& s = *shared_;
  const std::lock_guard lock(s.mutex);
  if (s.fault.load() == HidFault::kWriteHangs)
    return s.path + ": write: the device did not take a report within " +
           std::to_string(kWriteLimit / 1ms) + " ms";
  return s.error;
}

HidCounts HidDevice::counts() const noexcept {
  const HidShared& s = *shared_;
  return {s.inputs.load(), s.rejected.load(), s.floods.load(), s.forces.load(),
          s.watchdog_zeros.load()};
}

}  // namespace hapgrid
