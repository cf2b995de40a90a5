// A HID device in use, or an event device of the kernel's (EvdevProtocol).
//
// Problem. hidapi waits for a report to come, and up to 5 s in the kernel until the device takes
// one. The haptic thread must not wait. So a reader thread puts the newest input into a triple
// buffer, and a writer thread takes the newest force from another one; each thread has a handle of
// its own. The haptic thread only copies, and wakes the writer by a semaphore.
//
// What happens when something goes wrong:
//
// | what                                | outcome                                                |
// |-------------------------------------|--------------------------------------------------------|
// | no input for timing().stall         | DeviceInput::stalled, the last position                |
// | cut reports, reports of other kinds | counted and ignored; if no others come, a stall        |
// | reports without pause               | the newest of every 64 is used; no thread starves      |
// | a read or write fails (unplugged)   | kFailed; zero force and stop reports are tried at once |
// | a write takes longer than 0.5 s     | kFailed, although the kernel may wait on               |
// | no send() for timing().watchdog     | zero force once, counted, until the next send()        |
// | stop() while a write hangs          | kFailed after a second; the thread goes on alone and   |
// |                                     | writes zero force as soon as the kernel lets it        |
// | the program stands still (SIGSTOP)  | zero force by the guard; kFailed when it goes on       |
// | the program vanishes                | see HidGuard                                           |
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "libcore/device/device.hpp"
#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

class HidGuard;
struct HidShared;

/// What happened so far.
struct HidCounts {
  std::uint64_t inputs = 0;          ///< input reports
  std::uint64_t rejected = 0;        ///< reports that were cut, or of another kind
  std::uint64_t floods = 0;          ///< times that 64 reports came without pause
  std::uint64_t forces = 0;          ///< forces that were written, including zero and repeated ones
  std::uint64_t watchdog_zeros = 0;  ///< zero forces because send() was not called for too long
};

class HidDevice : public Device {
 public:
  /// Opens the path, starts the device, and waits 2 s at most for its first input, so that no
  /// position is made up. Only a device that is silent at rest (timing().stall is 0) and does not
  /// greet counts as being at 0 until its first input. Call this before the thread becomes
  /// real-time: the threads that it starts would inherit that; set_priority() gives them theirs.
  /// @param guard watches the device, from before start() until stop() returned kOk; null: none. It
  /// must live longer than this object.
  /// @throw DeviceError; std::system_error when no thread can be started. The device was stopped.
  HidDevice(const std::string& path, std::unique_ptr<HidProtocol> protocol,
            HidGuard* guard = nullptr);
  /// Calls stop().
  ~HidDevice() override;

  DeviceInfo info() const override { return info_; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  void snap() noexcept override { ++snaps_; }
  DeviceStatus stop() noexcept override;
  bool set_priority(int priority) noexcept override;
  std::string error() const override;

  HidCounts counts() const noexcept;

 private:
  std::thread start_thread(void (HidShared::*loop)(), bool HidShared::*done);

  DeviceInfo info_;
  std::shared_ptr<HidShared> shared_;  // with the threads, which may live longer than this
  HidGuard* guard_;
  std::thread reader_, writer_;
  std::uint64_t snaps_ = 0;
  bool stopped_ = false;
  DeviceStatus stop_status_ = DeviceStatus::kFailed;
};

}  // namespace hapgrid
