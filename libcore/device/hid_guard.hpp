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

#include <memory>
#include <string>
#include <vector>

#include "libcore/device/guard_process.hpp"
#include "libcore/device/hid_protocol.hpp"

namespace hapgrid {

class HidGuard {
 public:
  /// See GuardProcess. @throw std::system_error
  HidGuard();
  // Without release() the child writes the stop reports, as after a crash.

  /// Makes the child responsible for the device at `path`, with these output reports in this order.
  /// The child opens the device now, because later the path may belong to another one. A later call
  /// changes the reports.
  /// @throw DeviceError when the child is gone or cannot open the device.
  void watch(const std::string& path, const std::vector<HidReport>& stop);
  /// The goodbye: the device was stopped, and the child ends.
  void release() noexcept;

  pid_t pid() const { return process_.pid(); }
  const std::shared_ptr<Heart>& heart() const { return process_.heart(); }

 private:
  GuardProcess process_;
};

}  // namespace hapgrid
