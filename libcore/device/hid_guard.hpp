// Who lets go of the device when this program cannot.
//
// Problem. A device holds the force that it was told last. Signal handlers and destructors send the
// zero force on every way out that a program sees, but it does not see SIGKILL, the OOM killer, or
// its own crash. Choice: a second, tiny process, that holds the device open, waits at the end of a
// socket that only this program has, and writes the stop reports when the socket closes without a
// goodbye. Alternatives: a handler for SIGSEGV (the state it would run in is broken, and SIGKILL
// has none), a service for everybody (to be installed), the kernel (hidraw has no such thing).
//
// What it does not see: a program that is stopped (SIGSTOP, Ctrl-Z) or in a debugger is not gone,
// and one that dumps core is gone when that is done. Devices with a watchdog of their own are
// better off: that is what keep-alive is for.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

class HidGuard {
 public:
  /// Forks: to be made before this program has a thread or much memory. The child leads a session
  /// of its own, ignores the signals of terminals and of a shutdown, and closes every descriptor
  /// that it inherits. @throw std::system_error
  HidGuard();
  /// Without release() the child writes the stop reports: as after a crash. Waits for it, a second
  /// at most.
  ~HidGuard();
  HidGuard(const HidGuard&) = delete;
  HidGuard& operator=(const HidGuard&) = delete;

  /// From now on the device at `path` is the one to stop, with these output reports, in their
  /// order. The child opens it now: later the path may be another device's. Again to change them.
  /// @throw DeviceError when the child is gone or cannot open the device.
  void watch(const std::string& path, const std::vector<HidReport>& stop);
  /// The goodbye: the device was stopped, there is nothing to guard any more.
  void release() noexcept;

  pid_t pid() const { return pid_; }

 private:
  FileDescriptor socket_;
  pid_t pid_ = -1;
};

}  // namespace hapgrid
