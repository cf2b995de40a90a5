// What the keeper's process does (keeper.hpp), and what it is asked.
#pragma once

#include <sys/types.h>

#include <functional>

namespace hapgrid {

/// A message over a SOCK_SEQPACKET socket. kStart comes with four files: the texts of
/// launch_text(), the child's standard input, output and error.
struct KeeperRequest {
  enum class Kind { kStart, kLook, kEnd } kind = Kind::kStart;
  pid_t pid = -1;  ///< of kLook and kEnd
};

struct KeeperAnswer {
  int error = 0;   ///< errno, when nothing was started
  pid_t pid = -1;  ///< that was started
  bool ended = false;
  int status = 0;  ///< after kEnd, what waitpid() says
};

/// Serves `socket` until the other end is closed, then kills all that was started, calls
/// `at_the_end`, and ends the process.
[[noreturn]] void become_keeper(int socket, const std::function<void()>& at_the_end);

}  // namespace hapgrid
