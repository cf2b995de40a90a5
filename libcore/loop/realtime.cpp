#include "libcore/loop/realtime.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <mutex>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/signals.hpp"

namespace hapgrid {

namespace {

/// The process's address space in bytes, all of which is locked.
std::uint64_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// In 10^6 bytes, rounded up.
std::uint64_t megabytes(std::uint64_t bytes) { return (bytes + 999'999) / 1'000'000; }

/// Takes the priority. @return why the system refused it, empty when it did not
std::string ask_for_priority() {
  rlimit busy{};
  if (::getrlimit(RLIMIT_RTTIME, &busy) == 0) {
    busy.rlim_cur = std::min<rlim_t>(busy.rlim_max, kLongestBusy / std::chrono::microseconds(1));
    ::setrlimit(RLIMIT_RTTIME, &busy);
  }
  const sched_param priority{.sched_priority = kRealtimePriority};
  const int error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &priority);
  if (error == 0) return "";
  return format("no SCHED_FIFO ({}: rtprio {} in /etc/security/limits.d)", std::strerror(error),
                kGuardPriority);
}

/// The stack grows when it is touched, which must not happen in a tick. Linux has mapped 128 KiB of
/// the first thread's from the start.
[[gnu::noinline]] void touch_stack() {
  volatile char ahead[256 << 10];
  for (std::size_t i = 0; i < sizeof ahead; i += 1024) ahead[i] = 0;
}

/// Locks the memory. @return why the system refused it, empty when it did not
std::string lock_memory() {
  // The limit is read first: with a lock that just fits, MCL_FUTURE makes later allocations fail.
  rlimit limit{};
  const std::uint64_t wanted = address_space() + (std::uint64_t{16} << 20);
  const bool privileged = ::geteuid() == 0;
  if (!privileged && ::getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur < wanted)
    return format(
        "memory not locked ({} MB, ulimit -l allows {}: memlock in /etc/security/limits.d)",
        megabytes(wanted), megabytes(limit.rlim_cur));
  if (::mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
    return format("memory not locked ({})", std::strerror(errno));
  touch_stack();
  return "";
}

/// While the descriptor is open, processors stay out of states that take longer than 0 us to leave.
FileDescriptor keep_awake() {
  FileDescriptor wish(::open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC));
  const std::int32_t microseconds = 0;
  if (wish && ::write(wish.get(), &microseconds, sizeof microseconds) != sizeof microseconds)
    return FileDescriptor();
  return wish;
}

}  // namespace

Realtime::Realtime(RealtimeMode mode, Device* device) : device_(device) {
  if (mode == RealtimeMode::kOff) {
    got_ = "not asked for";
    return;
  }
  const std::string memory = lock_memory();
  locked_ = memory.empty();
  std::string priority = ask_for_priority();
  scheduled_ = priority.empty();
  if (scheduled_ && device_ && !device_->set_priority(kDevicePriority)) {
    give_priority_back();
    priority =
        format("no SCHED_FIFO for the device's threads (rtprio {} in /etc/security/limits.d)",
               kGuardPriority);
  }
  awake_ = keep_awake();
  got_ = format("{}, {}{}", scheduled_ ? format("SCHED_FIFO {}", kRealtimePriority) : priority,
                locked_ ? "memory locked" : memory, awake_ ? ", processors awake" : "");
  if (mode == RealtimeMode::kRequire && !(scheduled_ && locked_)) {
    const std::string why = got_;
    if (locked_) ::munlockall();
    if (scheduled_) give_priority_back();
    throw Error(format("real time was required: {}", why));
  }
  if (scheduled_ && device_) share_processor();
}

/// Waking up another processor takes longer than all the rest of a force's way (tests/bench). The
/// adapter's higher priority makes the way a switch between two processes; without real time it
/// would have to wait for its turn.
void Realtime::share_processor() {
  const int processor = ::sched_getcpu();
  if (processor < 0 || processor >= CPU_SETSIZE) return;
  if (::sched_getaffinity(0, sizeof allowed_, &allowed_) != 0) return;
  if (!device_->share_processor(processor)) return;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  bound_ = ::sched_setaffinity(0, sizeof one, &one) == 0;
  if (bound_) got_ += format(", loop and adapter on processor {}", processor);
}

void Realtime::give_priority_back() noexcept {
  const sched_param none{};
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &none);
  if (device_) device_->set_priority(0);
  scheduled_ = false;
}

Realtime::~Realtime() {
  if (bound_) ::sched_setaffinity(0, sizeof allowed_, &allowed_);
  if (scheduled_) give_priority_back();
  if (locked_) ::munlockall();
}

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
