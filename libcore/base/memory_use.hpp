// How much memory processes have at the moment.
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace hapgrid {

/// Resident bytes of this process; 0 where the kernel does not say.
std::uint64_t memory_of_this_process();
/// Of all processes of a group together: what a command started, and what that has started.
std::uint64_t memory_of_group(pid_t group);

}  // namespace hapgrid
