// The end of an adapter: whoever ends, the last thing that the motors hear is zero.
//
// This is the one place with the order in which an adapter is asked, told and forced to let go of
// its device. The guard follows it; play does so itself when its guard is dead or stands still.
//
// | step | what                                      | then it has            |
// |------|-------------------------------------------|------------------------|
// | 1    | the last message, of zero force           | 0.1 s to confirm it    |
// | 2    | SIGTERM, on which our own adapters let go | 0.1 s to end           |
// | 3    | SIGKILL                                   |                        |
// | 4    | the adapter again, with --release         | 2 s to send zero force |
//
// An adapter that confirms the zero skips all other steps. One that dies by itself skips to the
// fourth, which needs an adapter that knows --release.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"

namespace hapgrid {

inline constexpr std::chrono::milliseconds kConfirmTime{100}, kTermTime{100};
/// From the last message, or SIGKILL, until an adapter that confirmed the zero must have ended.
inline constexpr std::chrono::milliseconds kLingerTime{2000};
inline constexpr std::chrono::milliseconds kReleaseTime{2000};
/// The number of the last force; no other force has it.
inline constexpr std::uint32_t kLastForce = ~std::uint32_t{0};

/// A process by a descriptor, which never means another process; none for a process that has ended
/// already. @throw std::system_error
FileDescriptor open_process(pid_t pid);

/// Zero force that needs no answer. Never waits. @return whether it was sent
bool send_zero(int wire) noexcept;

/// How far it had to go.
enum class LetGo { kConfirmed, kEndedByItself, kTerminated, kKilled };

/// Steps 1 to 3. @param wire play's end of the adapter's socket. @param process of open_process().
/// @param confirm_time for the first step; less where an adapter has had its time already.
LetGo let_go(int wire, int process, std::chrono::milliseconds confirm_time = kConfirmTime) noexcept;

/// Whether the process has ended, within `patience`.
bool has_ended(int process, std::chrono::milliseconds patience) noexcept;

/// Step 4: starts `command` with --release, and kills it when it needs longer than kReleaseTime.
/// @return whether it exited with 0
bool release(const std::vector<std::string>& command) noexcept;

/// The arguments for execvp(), which point into `words`.
std::vector<char*> argument_list(std::vector<std::string>& words);

/// In a child before exec: signals as every program has them.
void restore_signals() noexcept;

}  // namespace hapgrid
