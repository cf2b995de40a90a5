// Processes that a process of ours starts, and those that they start in turn.
//
// A process that daemonises leaves its group, its session and its parent, and may clear its
// environment, but not its family: the kernel gives an orphan to the nearest ancestor that is a
// subreaper. So what starts a stranger's program here is a small process of its own that is one
// (the keeper of models, the guard of an adapter), which outlives this program for as long as it
// takes to kill all its children, and theirs when they become its own.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace hapgrid {

/// Makes the calling process the one that gets the orphans of what it starts.
void become_subreaper() noexcept;

/// In a child, between fork and exec: it leads a group of its own, and the kernel kills it with
/// its parent's thread that forked it.
/// @param parent the process that forked
void begin_child(pid_t parent) noexcept;

/// The processes whose parent is the calling one, which has one thread; empty where /proc cannot
/// tell.
std::vector<pid_t> children();

/// Kills all children of the calling process, which has one thread and is a subreaper, and
/// what they started; returns when all are gone, or after a second.
void kill_family();

/// How a process ended, from what waitpid() says: "exited with status 3".
std::string how_it_ended(int status);

}  // namespace hapgrid
