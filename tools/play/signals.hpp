// The signals that end a play in good order: they set a flag that the loop reads.
#pragma once

#include <signal.h>

#include <array>
#include <atomic>

namespace hapgrid {

/// The signal that was caught, 0 for none.
extern std::atomic<int> caught_signal;

/// While it lives, SIGINT, SIGTERM, SIGHUP and SIGQUIT set caught_signal instead of ending the
/// process. So does SIGTSTP (Ctrl-Z), which would stop the process with a force on the device. A
/// signal that was ignored stays ignored (nohup).
class CaughtSignals {
 public:
  CaughtSignals();
  ~CaughtSignals();
  CaughtSignals(const CaughtSignals&) = delete;
  CaughtSignals& operator=(const CaughtSignals&) = delete;

 private:
  static constexpr std::array<int, 5> kSignals{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP};
  std::array<struct sigaction, 5> before_{};
};

}  // namespace hapgrid
