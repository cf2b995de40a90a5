// A signal interrupts the thread of the tool that waits for it, so the other threads block signals.
#pragma once

#include <pthread.h>
#include <signal.h>
#include <time.h>

#include <cerrno>

namespace hapgrid {

/// While an object lives, the calling thread blocks all signals. A thread that it starts meanwhile
/// blocks them for good. The handlers of play have to interrupt the haptic loop, which is another
/// thread.
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

/// While an object lives, the calling thread blocks SIGPIPE, so that a write to a pipe whose other
/// end is closed fails with EPIPE and does not end the program. A SIGPIPE that such a write left
/// pending is removed at the end.
class NoSigpipe {
 public:
  NoSigpipe() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    sigset_t before, pending;
    ::sigpending(&pending);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before);
    blocks_ = !::sigismember(&before, SIGPIPE) && !::sigismember(&pending, SIGPIPE);
  }
  ~NoSigpipe() {
    if (!blocks_) return;
    const timespec at_once{};
    while (::sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
    }
    ::pthread_sigmask(SIG_UNBLOCK, &pipe_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t pipe_;
  bool blocks_;  // SIGPIPE was neither blocked nor pending before
};

}  // namespace hapgrid
