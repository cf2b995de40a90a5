// Threads that no signal interrupts.
#pragma once

#include <pthread.h>
#include <signal.h>

namespace hapgrid {

/// While it lives signals are blocked in this thread: a thread that is started now never gets one.
/// The handlers of a tool have to interrupt the thread that waits, which is another one.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_;
};

}  // namespace hapgrid
