// The end of an adapter: whoever ends, the last thing that the motors hear is zero.
//
// This is the one place with the order in which an adapter is asked, told and forced to let go of
// its device. The guard follows it; play does so itself when its guard is dead or stands still.
//
// | step | what                                      | then it has            |
// |------|-------------------------------------------|------------------------|
// | 1    | the last message, of zero force           | 0.1 s to confirm it    |
// | 2    | SIGTERM, on which our own adapters let go | 0.1 s to end           |
// | 3    | SIGKILL                                   |                        |
// | 4    | the adapter again, with --release         | 2 s to send zero force |
//
// The process that was started may be a script, or one that has left the work to a child. So "the
// adapter" is whoever holds the other end of its socket, and all that the first process started:
// each of them is told, and it has ended when nobody is left. Nothing else may kill it before step
// 3, since only it can let go where there is no --release.
//
// An adapter that confirms the zero skips all other steps. One of which nobody is left skips to the
// fourth, which needs an adapter that knows --release.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"

namespace hapgrid {

inline constexpr std::chrono::milliseconds kConfirmTime{100}, kTermTime{100};
/// From the last message, or SIGKILL, until an adapter that confirmed the zero must have ended.
inline constexpr std::chrono::milliseconds kLingerTime{2000};
inline constexpr std::chrono::milliseconds kReleaseTime{2000};
/// The number of the last force; no other force has it.
inline constexpr std::uint32_t kLastForce = ~std::uint32_t{0};

/// An adapter, and what it has started.
class Family {
 public:
  Family() = default;
  Family(const Family&) = delete;
  Family& operator=(const Family&) = delete;
  virtual ~Family() = default;
  /// Whether nobody is left. Never waits.
  virtual bool has_ended() noexcept = 0;
  /// Sends a signal to each of them, SIGTERM but once.
  virtual void tell(int signal) noexcept = 0;
};

/// The family as far as a process that is not its parent knows it: the adapter's process group, and
/// whoever holds the other end of the socket.
class AdapterGroup : public Family {
 public:
  /// @param wire play's end of the socket. @param leader of the group. @throw std::system_error
  AdapterGroup(int wire, pid_t leader);
  bool has_ended() noexcept override;
  void tell(int signal) noexcept override;
  pid_t leader() const { return leader_; }

 private:
  int wire_;
  pid_t leader_, session_;
  FileDescriptor process_;  // which never means another process; none where it had ended already
};

/// Zero force that needs no answer. Never waits. @return whether it was sent
bool send_zero(int wire) noexcept;

/// Steps 1 to 3. @param wire play's end of the adapter's socket.
/// @param confirm_time for the first step; less where an adapter has had its time already.
/// @return whether the adapter confirmed the zero
bool let_go(int wire, Family& family,
            std::chrono::milliseconds confirm_time = kConfirmTime) noexcept;

/// Step 4: starts `command` with --release, and kills it when it needs longer than kReleaseTime.
/// @return whether it exited with 0
bool release(const std::vector<std::string>& command) noexcept;

}  // namespace hapgrid
