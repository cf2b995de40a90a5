// A HID device in use.
//
// Problem. hidapi waits: for a report to come, and up to 5 s in the kernel for one to be taken. The
// haptic thread must not. So a reader thread leaves the newest input in a triple buffer, and a
// writer thread takes the newest force from another one; each has a handle of its own. The haptic
// thread only copies, and wakes the writer by a semaphore.
//
// What happens when something goes wrong:
//
// | what                                | outcome                                                |
// |-------------------------------------|--------------------------------------------------------|
// | no input for timing().stall         | DeviceInput::stalled, the last position                |
// | reports that are cut, or others     | counted; they are no input (and in the end a stall)    |
// | reports without pause               | the newest of every 64 counts; no thread starves       |
// | a read or write fails (unplugged)   | kFailed; zero force and stop reports are tried at once |
// | a write takes longer than 0.5 s     | kFailed, although the kernel may wait on               |
// | no send() for timing().watchdog     | zero force once, counted; the next send() counts again |
// | stop() while a write hangs          | kFailed after a second; the thread is left to itself   |
// |                                     | and writes zero force when the kernel lets it          |
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
  std::uint64_t inputs = 0;          ///< reports that were input
  std::uint64_t rejected = 0;        ///< reports that were not: cut, or of another kind
  std::uint64_t floods = 0;          ///< 64 reports came without pause
  std::uint64_t forces = 0;          ///< forces that were written, zero and repeated ones, too
  std::uint64_t watchdog_zeros = 0;  ///< send() did not come for too long
};

class HidDevice : public Device {
 public:
  /// Opens the path, starts the device, and waits for its first input, 2 s at most: a position is
  /// never made up. Only a device whose silence is its rest (timing().stall is 0) is taken to be at
  /// 0 until then. To be called before the thread becomes real-time, which its threads would
  /// inherit.
  /// @param guard if there is one, watches from before start() until stop() was answered by kOk; it
  /// must live longer than this.
  /// @throw DeviceError; std::system_error for no more threads. The device was stopped, then.
  HidDevice(const std::string& path, std::unique_ptr<HidProtocol> protocol,
            HidGuard* guard = nullptr);
  /// As stop(); then waits at most another moment for the reader.
  ~HidDevice() override;

  DeviceInfo info() const override { return info_; }
  DeviceStatus read(DeviceInput& input) noexcept override;
  DeviceStatus send(const Vec3& force) noexcept override;
  DeviceStatus stop() noexcept override;
  std::string error() const override;

  HidCounts counts() const noexcept;

 private:
  std::thread start_thread(void (HidShared::*loop)(), bool HidShared::*done);

  DeviceInfo info_;
  std::shared_ptr<HidShared> shared_;  // with the threads, which may live longer than this
  HidGuard* guard_;
  std::thread reader_, writer_;
  bool stopped_ = false;
  DeviceStatus stop_status_ = DeviceStatus::kFailed;
};

}  // namespace hapgrid
