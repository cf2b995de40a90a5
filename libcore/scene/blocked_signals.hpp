// A thread that never gets a signal.
#pragma once

#include <pthread.h>
#include <signal.h>

namespace hapgrid {

/// While it lives signals are blocked: a thread that is started now never gets one. The handlers of
/// play have to interrupt the haptic loop, which is another thread.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace hapgrid
