// A second process that sends zero force to the device when this program cannot.
//
// Problem. A device holds the last force that it got. The program sends zero force on every way out
// that it notices, but it does not notice SIGKILL, the OOM killer, or its own crash. Choice: a
// small process holds the device open and waits at the end of a socket that only this program has.
// When the socket closes without a goodbye, the process writes the stop reports. It does so, too,
// when the program's heart stops: SIGSTOP and debuggers stop a program without ending it, and a
// core is written before the socket closes. Alternatives: a handler for SIGSEGV (the program's
// state is broken, and SIGKILL has no handler), a service (somebody must install it), the kernel
// (hidraw has nothing of the kind).
//
// A device with a watchdog of its own is safer: keep-alive reports are there for it.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

/// The program beats it at least every kHidBeat while the device may have a force; the guard looks
/// at it. Both have the same memory.
struct HidHeart {
  std::atomic<std::uint64_t> beats{0};  ///< 0: it has not begun to beat
  /// The guard let go, since the heart stopped. The program must not send forces any more: nobody
  /// knows in which state the device is.
  std::atomic<bool> let_go{false};
};
inline constexpr std::chrono::milliseconds kHidBeat{10};
/// A heart that was silent at so many looks of the guard has stopped. The looks are 20 ms apart,
/// and more where the machine is busy, which then holds for the program as well.
inline constexpr int kHidSilentLooks = 25;

class HidGuard {
 public:
  /// Forks, so make it before this program has threads or much memory. The child leads a session of
  /// its own, ignores the signals of terminals and of a shutdown, and closes every descriptor that
  /// it inherits. @throw std::system_error
  HidGuard();
  /// Without release() the child writes the stop reports, as after a crash. Waits a second at most
  /// for the child's end.
  ~HidGuard();
  HidGuard(const HidGuard&) = delete;
  HidGuard& operator=(const HidGuard&) = delete;

  /// Makes the child responsible for the device at `path`, with these output reports in this order.
  /// The child opens the device now, because later the path may belong to another one. A later call
  /// changes the reports.
  /// @throw DeviceError when the child is gone or cannot open the device.
  void watch(const std::string& path, const std::vector<HidReport>& stop);
  /// The goodbye: the device was stopped, and the child ends.
  void release() noexcept;

  pid_t pid() const { return pid_; }
  const std::shared_ptr<HidHeart>& heart() const { return heart_; }

 private:
  std::shared_ptr<HidHeart> heart_;
  FileDescriptor socket_;
  pid_t pid_ = -1;
};

}  // namespace hapgrid
