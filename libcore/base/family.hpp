// What starting a foreign program needs.
#pragma once

#include <sys/types.h>

#include <string>

namespace hapgrid {

/// Called in a child between fork and exec. The child becomes the leader of a new process group,
/// and the kernel kills it when the thread that forked it ends.
/// @param parent the process that forked
void begin_child(pid_t parent) noexcept;

/// How a process ended, from the status of waitpid(): "exited with status 3".
std::string how_it_ended(int status);

}  // namespace hapgrid
