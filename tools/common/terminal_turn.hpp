// Who may write on the terminal: a program that fills the screen takes it, and what others have to
// say waits until the usual screen is back. Else `play | view --terminal` would lose play's last
// words.
#pragma once

#include "libcore/base/file.hpp"

namespace hapgrid {

/// The terminal belongs to this process while the object lives, and to nobody once the process is
/// gone: it is a lock (flock(2)) on the terminal's device. Where it cannot be locked nothing
/// happens.
class TerminalTurn {
 public:
  /// @param fd an open file of the terminal.
  explicit TerminalTurn(int fd);

 private:
  FileDescriptor terminal_;
};

/// Waits until nobody has taken the terminal of standard error, for two seconds at most; not at all
/// where standard error is no terminal.
void wait_for_terminal();

}  // namespace hapgrid
