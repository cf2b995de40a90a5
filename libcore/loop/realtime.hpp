// Gives the haptic thread and the threads of its device real-time priorities, and memory that is
// never paged out. A system refuses one or both to a user without the right limits. play prints
// what it got, because a user feels a force that stutters and does not know why.
#pragma once

#include <sched.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "libcore/base/file.hpp"
#include "libcore/device/device.hpp"
#include "libcore/device/guard_words.hpp"

namespace hapgrid {

enum class RealtimeMode {
  kRequire,  ///< all of it, or an error
  kTry,      ///< as much as the system allows
  kOff,
};

/// Linux runs its interrupt threads at 50. A loop above them would starve the USB stack that feeds
/// its device.
inline constexpr int kRealtimePriority = 40;
/// Of an adapter, which has little to do: each force passes through it, and must not wait for the
/// next tick.
inline constexpr int kDevicePriority = kAdapterPriority;

/// The kernel sends SIGXCPU to a process with a thread that computes for so long at its real-time
/// priority and never waits: it would keep all others from its processor.
inline constexpr std::chrono::seconds kLongestBusy{1};

/// While an object lives, the calling thread and those of the device are under SCHED_FIFO, the
/// process's memory is locked, and the processors are asked not to sleep deeply
/// (/dev/cpu_dma_latency), because waking up makes ticks late. A device that can share a processor
/// is bound to that of the calling thread, which stays there. Other threads that exist already keep
/// their policy and processors.
class Realtime {
 public:
  /// @throw Error with kRequire when something was refused: what it is, its limit, and how to raise
  /// the limit.
  /// @param device it must live longer than this object; null: none.
  explicit Realtime(RealtimeMode mode, Device* device = nullptr);
  /// Gives back what the calling thread got.
  ~Realtime();
  Realtime(const Realtime&) = delete;
  Realtime& operator=(const Realtime&) = delete;

  /// What the system gave, and why it gave no more, in one line: "SCHED_FIFO 40, memory locked,
  /// processors awake, loop and adapter on processor 1".
  const std::string& got() const { return got_; }

 private:
  void give_priority_back() noexcept;
  void share_processor();

  Device* device_;
  bool scheduled_ = false;
  bool locked_ = false;
  bool bound_ = false;
  cpu_set_t allowed_{};   // before it was bound
  FileDescriptor awake_;  // the wish holds as long as it is open
  std::string got_;
};

// Watches the haptic loop from another thread. A force function that never returns would leave the
// hand with the last force.

/// Calls `hung` once, in the thread that is returned, when `heartbeat` has not changed for
/// `patience`. The thread's destructor ends the watch.
std::jthread start_watchdog(const std::atomic<std::uint64_t>& heartbeat,
                            std::chrono::milliseconds patience, std::function<void()> hung);

}  // namespace hapgrid
