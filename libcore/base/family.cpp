#include "libcore/base/family.hpp"

#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>
#include <vector>

#include "libcore/base/format.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

constexpr auto kKilling = 1s;
constexpr auto kPause = 1ms;

/// The processes whose parent is the calling one, which has one thread.
std::vector<pid_t> children() {
  const std::string self = std::to_string(::getpid());
  std::ifstream file("/proc/self/task/" + self + "/children");
  std::vector<pid_t> all;
  for (pid_t child; file >> child;) all.push_back(child);
  return all;
}

}  // namespace

void become_subreaper() noexcept { ::prctl(PR_SET_CHILD_SUBREAPER, 1); }

void begin_child(pid_t parent) noexcept {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::raise(SIGKILL);  // it died before prctl()
}

void kill_family() {
  const auto deadline = std::chrono::steady_clock::now() + kKilling;
  // Processes whose parent was killed are children of this process in the next round.
  for (std::vector<pid_t> alive; !(alive = children()).empty();) {
    for (const pid_t child : alive) ::kill(child, SIGKILL);
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    if (std::chrono::steady_clock::now() >= deadline) return;
    std::this_thread::sleep_for(kPause);
  }
}

std::string how_it_ended(int status) {
  if (!WIFSIGNALED(status)) return format("exited with status {}", WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  const char* name = ::sigdescr_np(signal);
  return format("was killed by signal {}", signal) + (name ? format(" ({})", name) : "");
}

}  // namespace hapgrid
