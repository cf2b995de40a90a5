// The guard of a device that is a process: it starts the adapter, takes the force off the hand when
// this program cannot, and ends every process that the adapter has left.
//
// Problem. An adapter that hangs holds the hand with the last force; one that has children or
// became a daemon outlives its parent; and this program may be killed or stopped before it could
// say the last word. Choice: the guard is the adapter's parent and, by PR_SET_CHILD_SUBREAPER, the
// heir of all that descends from it. It has a copy of this program's end of the adapter's socket.
// When this program is gone or stands still, the guard sends the last message of the protocol,
// waits until the adapter ended, and kills what is left. When the guard itself is killed, the
// kernel kills the adapter with it (PR_SET_PDEATHSIG). Alternatives: the adapter notices by itself
// (a good one does, after HAPGRID_DEVICE_SILENCE; this is for the others), a control group (it
// needs rights that a user may not have).
#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcore/device/guard_process.hpp"

namespace hapgrid {

class ProcessGuard {
 public:
  /// Starts nothing yet. See GuardProcess. @param command program, looked up in PATH, and
  /// arguments.
  /// @throw std::system_error
  explicit ProcessGuard(std::vector<std::string> command);
  // The destructor waits until the adapter and all that it started are gone, 4 s at most.

  /// Starts the adapter; once. @throw DeviceError
  void start();
  /// Kills the adapter and all that it started, at once.
  /// @return how the adapter had ended by itself, "exited with status 3"; empty when it had not
  std::string kill() noexcept;
  /// The goodbye: the adapter took the last message. It gets 2 s to end by itself.
  void release() noexcept;

  /// "process 'CMD ARGS'"
  const std::string& name() const { return name_; }
  /// This program's end of the adapter's socket.
  int wire() const { return wire_.get(); }
  pid_t adapter() const { return adapter_; }
  Heart& heart() const { return *process_->heart(); }

 private:
  std::string name_;
  FileDescriptor wire_;
  std::optional<GuardProcess> process_;
  pid_t adapter_ = -1;
};

}  // namespace hapgrid
