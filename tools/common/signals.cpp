#include "tools/common/signals.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "libcore/base/file.hpp"

namespace hapgrid {

std::atomic<int> caught_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);  // or a handler may not use it

namespace {

// Written before a handler can run.
const char* notice_line = nullptr;
pid_t process = 0;

}  // namespace

extern "C" {
static void end_without_unfinished_files(int signal) {
  // A child between fork and exec has the handler, too, and its parent still needs the files.
  if (::getpid() == process) remove_unfinished_files();
  ::signal(signal, SIG_DFL);
  ::raise(signal);  // ends the process when this handler returns
}

static void catch_signal(int signal) {
  caught_signal.store(signal, std::memory_order_relaxed);
  if (!notice_line) return;
  const int error = errno;
  static_cast<void>(!::write(STDERR_FILENO, notice_line, std::strlen(notice_line)));
  errno = error;
  ::signal(signal, end_without_unfinished_files);  // once more: at once
}
}

CaughtSignals::CaughtSignals(std::span<const int> signals, const char* notice) : signals_(signals) {
  notice_line = notice;
  struct sigaction action {};
  action.sa_handler = catch_signal;
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    ::sigaction(signals_[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) ::sigaction(signals_[i], &action, nullptr);
  }
}

CaughtSignals::~CaughtSignals() {
  for (std::size_t i = 0; i < signals_.size(); ++i) ::sigaction(signals_[i], &before_[i], nullptr);
}

void remove_unfinished_files_on_signals() {
  process = ::getpid();
  for (const int signal : CaughtSignals::kEnding) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_DFL) ::signal(signal, end_without_unfinished_files);
  }
}

}  // namespace hapgrid
