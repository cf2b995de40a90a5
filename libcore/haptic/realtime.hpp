// The haptic thread's claim on the machine: a real-time priority, and memory that is never paged
// out. A desktop refuses one or both to a user without the right limits; what was got is told,
// because a force that stutters is felt and not understood.
#pragma once

#include <string>

#include "libcore/base/file.hpp"

namespace hapgrid {

enum class RealtimeMode {
  kRequire,  ///< all of it, or an error
  kTry,      ///< what there is
  kOff,
};

/// Below 50, where Linux has its interrupt threads: a loop above them starves the USB stack that
/// feeds its device.
inline constexpr int kRealtimePriority = 40;

/// While it lives the calling thread is under SCHED_FIFO, the process's memory is locked, and the
/// processors are asked not to sleep deeply (/dev/cpu_dma_latency; what waking up from there takes
/// is lateness). Threads that exist already keep their policy.
class Realtime {
 public:
  /// @throw Error with kRequire when something was refused: what, the limit, and how to raise it.
  explicit Realtime(RealtimeMode mode);
  /// Takes both back.
  ~Realtime();
  Realtime(const Realtime&) = delete;
  Realtime& operator=(const Realtime&) = delete;

  bool scheduled() const { return scheduled_; }  ///< SCHED_FIFO at kRealtimePriority
  bool locked() const { return locked_; }
  /// One line on what was got, and why not more: "SCHED_FIFO 40, memory locked, processors awake".
  const std::string& got() const { return got_; }

 private:
  bool scheduled_ = false;
  bool locked_ = false;
  FileDescriptor awake_;  // the wish holds as long as it is open
  std::string got_;
};

}  // namespace hapgrid
