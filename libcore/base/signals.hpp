// Signals belong to the thread that the tool waits in: no thread of the library takes one.
#pragma once

#include <pthread.h>
#include <signal.h>

namespace hapgrid {

/// While it lives all signals are blocked in this thread, and so for good in a thread that is
/// started now. The handlers of play have to interrupt the haptic loop, which is another thread.
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
