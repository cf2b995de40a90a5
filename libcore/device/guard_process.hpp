// The process of a guard: it lives until this program ends, however that happens, and notices when
// this program stands still.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "libcore/base/file.hpp"

namespace hapgrid {

/// The program beats it at least every kHeartBeat while the device may have a force; the guard
/// looks at it. Both have the same memory.
struct Heart {
  std::atomic<std::uint64_t> beats{0};  ///< 0: it does not beat, and nobody expects it to
  /// The guard took the force off the device because the heart stopped. The program must not send
  /// forces any more: nobody knows in which state the device is.
  std::atomic<bool> let_go{false};
};
inline constexpr std::chrono::milliseconds kHeartBeat{10};
/// A heart that was silent at so many looks of the guard has stopped. The looks are 20 ms apart,
/// and more where the machine is busy, which then holds for the program as well.
inline constexpr int kSilentLooks = 25;

class GuardProcess {
 public:
  /// The work of the child until its end. The socket keeps the boundaries of messages; it is closed
  /// when the program is gone.
  using Life = std::function<void(int socket, Heart& heart)>;
  static constexpr int kFirstKept = 4;

  /// Forks, so make it before this program has threads or much memory. The child leads a session of
  /// its own, ignores the signals of terminals and of a shutdown, and closes every descriptor that
  /// it inherits, but for those `kept`, which become kFirstKept and the numbers after it. Its
  /// standard streams are /dev/null. @throw std::system_error
  GuardProcess(const char* name, std::span<const int> kept, const Life& life);
  /// Closes the socket, and waits `patience()` at most for the child's end.
  ~GuardProcess();
  GuardProcess(const GuardProcess&) = delete;
  GuardProcess& operator=(const GuardProcess&) = delete;

  void set_patience(std::chrono::milliseconds patience) { patience_ = patience; }
  int socket() const { return socket_.get(); }
  pid_t pid() const { return pid_; }
  const std::shared_ptr<Heart>& heart() const { return heart_; }

  /// Sends a message and waits 2 s at most for the answer.
  /// @return bytes of the answer, 0 or less when the child is gone or silent
  ssize_t ask(std::span<const char> message, std::span<char> answer) noexcept;

 private:
  std::shared_ptr<Heart> heart_;
  FileDescriptor socket_;
  pid_t pid_ = -1;
  std::chrono::milliseconds patience_{1000};
};

/// In the child: waits for a message or for the end of the socket. When the heart stops meanwhile,
/// sets Heart::let_go and calls `let_go` once.
void wait_for_message(int socket, Heart& heart, const std::function<void()>& let_go);
/// In a child of the child: takes signals again as every program does.
void restore_signals() noexcept;

}  // namespace hapgrid
