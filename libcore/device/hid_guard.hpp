// A second process that sends zero force to the device when this program cannot.
//
// Problem. A device holds the last force that it got. The program sends zero force on every way out
// that it notices, but it does not notice SIGKILL, the OOM killer, or its own crash. Choice: a
// small process holds the device open and waits at the end of a socket that only this program has.
// When the socket closes without a goodbye, the process writes the stop reports. Alternatives: a
// handler for SIGSEGV (the program's state is broken, and SIGKILL has no handler), a service
// (somebody must install it), the kernel (hidraw has nothing of the kind).
//
// The guard does not act for a program that is stopped (SIGSTOP) or in a debugger, and for one that
// dumps core only when the core is written. A device with a watchdog of its own is safer:
// keep-alive reports are there for it.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

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

 private:
  FileDescriptor socket_;
  pid_t pid_ = -1;
};

}  // namespace hapgrid
