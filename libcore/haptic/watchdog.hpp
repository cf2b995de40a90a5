// Watches the haptic loop from another thread. A force function that never returns would leave the
// hand with the last force.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

namespace hapgrid {

class Watchdog {
 public:
  /// Calls `hung` once, in a thread of its own, when `heartbeat` has not changed for `patience`.
  Watchdog(const std::atomic<std::uint64_t>& heartbeat, std::chrono::milliseconds patience,
           std::function<void()> hung);
  // The destructor ends the watch.

 private:
  std::jthread thread_;
};

}  // namespace hapgrid
