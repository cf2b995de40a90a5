// play's side of the guard: starts it (tools/devices/guard.cpp), and tells it that play lives.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/device/let_go.hpp"

namespace hapgrid {

/// An adapter, and how it is started.
struct AdapterProgram {
  std::vector<std::string> command;  ///< program, looked up in PATH, and arguments
  std::string name;                  ///< for messages
  std::string guard;                 ///< the file of the guard's program
};

/// How often play says that it lives, while it may send forces.
inline constexpr std::chrono::milliseconds kGuardBeatTime{10};

class ProcessGuard {
 public:
  /// Starts the guard, which starts the adapter. Opens every file and allocates all memory that
  /// end() needs before the adapter starts. @throw DeviceError, std::system_error
  explicit ProcessGuard(AdapterProgram program);
  /// Calls end(), and waits until the guard, the adapter and all that it started are gone, 4 s at
  /// most.
  ~ProcessGuard();
  ProcessGuard(const ProcessGuard&) = delete;
  ProcessGuard& operator=(const ProcessGuard&) = delete;

  const std::string& name() const { return program_.name; }
  /// This program's end of the adapter's socket.
  int wire() const { return wire_.get(); }
  pid_t adapter() const { return group_->leader(); }
  pid_t pid() const { return guard_; }

  /// The adapter knows --release.
  void set_releases() noexcept;
  /// Says that this program lives. Real-time safe. @return false when the guard is gone
  bool beat() noexcept;
  /// Ends the adapter as let_go.hpp says, by the guard, or by itself when the guard is dead or
  /// stands still. Later calls do nothing and return the same.
  /// @return whether the adapter confirmed the last zero force
  bool end() noexcept;

  /// After end(): how the adapter had ended by itself, "exited with status 3"; empty when it had
  /// not.
  const std::string& how_it_ended() const { return how_; }
  /// After end(): why the guard ended the adapter (guard_words.hpp); 0 where it was no guard.
  char why() const { return why_; }
  /// After end(), of an adapter that did not confirm: whether its --release sent zero force.
  bool released() const { return released_; }

 private:
  std::string ask_guard();
  void wait_for_guard() noexcept;

  AdapterProgram program_;
  FileDescriptor wire_, socket_;
  std::optional<AdapterGroup> group_;
  pid_t guard_ = -1;  // -1: it was waited for
  bool releases_ = false;
  bool ended_ = false, confirmed_ = false, released_ = false;
  char why_ = 0;
  std::string how_;
};

}  // namespace hapgrid
