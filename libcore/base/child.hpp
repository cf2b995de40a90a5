// What starting a foreign program, and waiting for it, needs.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace hapgrid {

/// Called in a child between fork and exec. The child becomes the leader of a new process group,
/// and the kernel kills it when the thread that forked it ends.
/// @param parent the process that forked
void begin_child(pid_t parent) noexcept;

/// In a child before exec: signals as every program has them.
void restore_signals() noexcept;

/// The arguments for execvp(), which point into `words`.
std::vector<char*> argument_list(std::vector<std::string>& words);

/// For poll(): 0 behind the deadline, at most 1000 s.
int milliseconds_until(std::chrono::steady_clock::time_point deadline) noexcept;

/// How a process ended, from the status of waitpid(): "exited with status 3".
std::string how_it_ended(int status);

// How much memory processes have at the moment.

/// Resident bytes of this process; 0 where the kernel does not say.
std::uint64_t memory_of_this_process();
/// Of all processes of a group together: what a command started, and what that has started.
std::uint64_t memory_of_group(pid_t group);

}  // namespace hapgrid
