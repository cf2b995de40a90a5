// What play and the guard of its adapter (tools/devices/guard.cpp) say to each other, on a socket
// that keeps the boundaries of messages. The first character tells what a message is.
#pragma once

namespace hapgrid {

// From play. The first message is the adapter's command: its words, a zero byte after each.
inline constexpr char kGuardBeat = 'b';      ///< play lives; about every kGuardBeatTime
inline constexpr char kGuardReleases = 'r';  ///< the adapter knows --release
inline constexpr char kGuardEnd = 'x';       ///< the end: do as let_go.hpp says

// From the guard.
inline constexpr char kGuardStarted = 'k';  ///< and the adapter's process id
inline constexpr char kGuardCannot = 'e';   ///< and why the adapter cannot be started
inline constexpr char kGuardHeard = 'h';    ///< it ends the adapter now
// The last one: 'c' or 'f', then why the guard ended the adapter, then how that had ended by
// itself. The guard ends with the exit code 0 when the motors heard zero.
inline constexpr char kGuardConfirmed = 'c';  ///< the adapter applied zero force
inline constexpr char kGuardForced = 'f';     ///< it did not
inline constexpr char kGuardAsked = 'a';      ///< play said so, or is gone
inline constexpr char kGuardStood = 's';      ///< play was silent for too long
inline constexpr char kGuardDeaf = 'd';       ///< so was play, and the adapter read nothing
inline constexpr char kGuardClosed = 'z';     ///< the adapter closed its socket

/// The descriptors of the guard: 2 is standard error, which the adapter gets.
inline constexpr int kGuardSocket = 0, kGuardWire = 1, kGuardAdaptersEnd = 3;

/// Linux runs its interrupt threads at 50, play's loop at 40, and adapters at 45: the guard is
/// above both, so that neither can keep it from its work by spinning.
inline constexpr int kAdapterPriority = 45, kGuardPriority = 46;

}  // namespace hapgrid
