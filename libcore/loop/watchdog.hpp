// Watches the haptic loop from another thread. A force function that never returns would leave the
// hand with the last force.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

namespace hapgrid {

/// Calls `hung` once, in the thread that is returned, when `heartbeat` has not changed for
/// `patience`. The thread's destructor ends the watch.
std::jthread start_watchdog(const std::atomic<std::uint64_t>& heartbeat,
                            std::chrono::milliseconds patience, std::function<void()> hung);

}  // namespace hapgrid
