#include "tools/common/terminal_turn.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

namespace hapgrid {

namespace {

/// The terminal, opened anew: a lock belongs to an open file, and programs of one shell share
/// theirs.
FileDescriptor open_again(int fd) {
  char name[256];
  if (::ttyname_r(fd, name, sizeof name) != 0) return {};
  return FileDescriptor(::open(name, O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
}

}  // namespace

TerminalTurn::TerminalTurn(int fd) : terminal_(open_again(fd)) {
  if (terminal_) ::flock(terminal_.get(), LOCK_EX | LOCK_NB);
}

void wait_for_terminal() {
  const FileDescriptor terminal = open_again(STDERR_FILENO);
  if (!terminal) return;
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (::flock(terminal.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK &&
         std::chrono::steady_clock::now() < patience)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

}  // namespace hapgrid
