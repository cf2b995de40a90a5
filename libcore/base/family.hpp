// What starting and killing a foreign program needs.
//
// A daemon leaves its process group, its session and its parent. When its parent ends, the kernel
// gives it to the nearest ancestor that is a subreaper. The guard of an adapter is one: it is a
// small helper process that starts the adapter. When hapgrid ends, the guard kills its children
// and the orphans that it inherits, and then ends itself.
#pragma once

#include <sys/types.h>

#include <string>

namespace hapgrid {

/// Makes the calling process the parent of orphans among its descendants.
void become_subreaper() noexcept;

/// Called in a child between fork and exec. The child becomes the leader of a new process group,
/// and the kernel kills it when the thread that forked it ends.
/// @param parent the process that forked
void begin_child(pid_t parent) noexcept;

/// Kills all descendants of the calling process, which has one thread and is a subreaper. Returns
/// when they are gone, or after a second. Without /proc, it kills nothing.
void kill_family();

/// How a process ended, from the status of waitpid(): "exited with status 3".
std::string how_it_ended(int status);

}  // namespace hapgrid
