#include "tools/play/signals.hpp"

namespace hapgrid {

std::atomic<int> caught_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);  // or a handler may not use it

extern "C" {
static void catch_signal(int signal) { caught_signal.store(signal, std::memory_order_relaxed); }
}

CaughtSignals::CaughtSignals() {
  struct sigaction action {};
  action.sa_handler = catch_signal;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) ::sigaction(kSignals[i], &action, nullptr);
  }
}

CaughtSignals::~CaughtSignals() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &before_[i], nullptr);
}

}  // namespace hapgrid
