// The signals that end a tool in good order: they set a flag that its work looks at.
#pragma once

#include <signal.h>

#include <array>
#include <atomic>
#include <span>

namespace hapgrid {

/// The signal that was caught, 0 for none.
extern std::atomic<int> caught_signal;

/// While it lives, signals set caught_signal instead of ending the process. A signal that was
/// ignored stays ignored (nohup).
class CaughtSignals {
 public:
  /// SIGINT, SIGTERM, SIGHUP and SIGQUIT.
  static constexpr std::array kEnding{SIGINT, SIGTERM, SIGHUP, SIGQUIT};
  /// SIGTSTP (Ctrl-Z), too, which would stop the process with a force on the device.
  static constexpr std::array kOfPlay{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP};

  /// @param notice a line for the user, written when a signal comes; the same signal once more
  /// then ends the process. Null: signals are caught each time, in silence.
  explicit CaughtSignals(std::span<const int> signals = kOfPlay, const char* notice = nullptr);
  ~CaughtSignals();
  CaughtSignals(const CaughtSignals&) = delete;
  CaughtSignals& operator=(const CaughtSignals&) = delete;

 private:
  std::span<const int> signals_;
  std::array<struct sigaction, kOfPlay.size()> before_{};
};

/// From now on a signal of kEnding that ends the process removes its unfinished files first. A
/// signal that is ignored or caught stays so.
void remove_unfinished_files_on_signals();

}  // namespace hapgrid
