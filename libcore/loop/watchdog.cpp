#include "libcore/loop/watchdog.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "libcore/base/signals.hpp"

namespace hapgrid {

std::jthread start_watchdog(const std::atomic<std::uint64_t>& heartbeat,
                            std::chrono::milliseconds patience, std::function<void()> hung) {
  const BlockedSignals blocked;
  return std::jthread([&heartbeat, patience, hung = std::move(hung)](const std::stop_token& token) {
    using Clock = std::chrono::steady_clock;
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    std::uint64_t last = heartbeat.load(std::memory_order_relaxed);
    Clock::time_point changed = Clock::now();
    while (!token.stop_requested()) {
      const Clock::time_point before = Clock::now();
      wake.wait_for(lock, token, patience / 4, [] { return false; });
      const std::uint64_t now = heartbeat.load(std::memory_order_relaxed);
      // When the whole machine stood still (a suspended laptop, a debugger), the loop does not
      // hang.
      const bool stood_still = Clock::now() - before > patience;
      if (now != last || stood_still) {
        last = now;
        changed = Clock::now();
      } else if (Clock::now() - changed >= patience && !token.stop_requested()) {
        hung();
        return;
      }
    }
  });
}

}  // namespace hapgrid
