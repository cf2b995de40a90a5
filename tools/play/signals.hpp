// The signals that end a play in good order: they set a flag that the loop looks at.
#pragma once

#include <signal.h>

#include <array>
#include <atomic>

namespace hapgrid {

/// The signal that was caught, 0 when none was.
extern std::atomic<int> caught_signal;

/// While it lives SIGINT, SIGTERM and SIGHUP set caught_signal instead of ending the process;
/// one that was ignored stays ignored (nohup).
class CaughtSignals {
 public:
  CaughtSignals();
  ~CaughtSignals();
  CaughtSignals(const CaughtSignals&) = delete;
  CaughtSignals& operator=(const CaughtSignals&) = delete;

 private:
  static constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> before_{};
};

}  // namespace hapgrid
