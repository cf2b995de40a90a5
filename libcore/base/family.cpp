#include "libcore/base/family.hpp"

#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "libcore/base/format.hpp"

namespace hapgrid {

void begin_child(pid_t parent) noexcept {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::kill(::getpid(), SIGKILL);  // it died before prctl()
}

std::string how_it_ended(int status) {
  if (!WIFSIGNALED(status)) return format("exited with status {}", WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  const char* name = ::sigdescr_np(signal);
  return format("was killed by signal {}", signal) + (name ? format(" ({})", name) : "");
}

}  // namespace hapgrid
