#include "libcore/device/let_go.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <string_view>
#include <system_error>

#include "libcore/base/child.hpp"
#include "libcore/device/guard_words.hpp"
#include "libcore/device/process_protocol.h"

namespace hapgrid {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

/// Reads answers until the one to the last force. @return false when it does not come in time, or
/// nobody is left who could send it
bool is_confirmed(int wire, Clock::time_point deadline) noexcept {
  for (;;) {
    pollfd ready{wire, POLLIN, 0};
    const int polled = ::poll(&ready, 1, milliseconds_until(deadline));
    if (polled < 0 && errno == EINTR) continue;
    if (polled <= 0) return false;
    hapgrid_device_state state[2];  // one more, so that a longer message is noticed
    const ssize_t got = ::recv(wire, state, sizeof state, MSG_DONTWAIT | MSG_PEEK);
    // Why the adapter ends is for play to read, which may share the socket.
    constexpr std::string_view kError = HAPGRID_DEVICE_ERROR;
    if (got >= static_cast<ssize_t>(kError.size()) &&
        std::memcmp(state, kError.data(), kError.size()) == 0)
      return false;
    if (got > 0) (void)!::recv(wire, state, 1, MSG_DONTWAIT);  // takes the whole message
    if (got == sizeof state[0] && state[0].number == kLastForce) return true;
    if (got == 0) return false;
    if (got < 0 && errno != EINTR && errno != EAGAIN && errno != ECONNRESET) return false;
    if (Clock::now() >= deadline) return false;  // whoever floods the socket lies
  }
}

bool ends_until(Family& family, Clock::time_point deadline) noexcept {
  while (!family.has_ended()) {
    if (Clock::now() >= deadline) return false;
    ::usleep(500);
  }
  return true;
}

}  // namespace

AdapterGroup::AdapterGroup(int wire, pid_t leader)
    : wire_(wire),
      leader_(leader),
      session_(::getsid(leader)),
      process_(static_cast<int>(::syscall(SYS_pidfd_open, leader, 0))) {
  if (!process_ && errno != ESRCH)
    throw std::system_error(errno, std::generic_category(), "the adapter's process");
}

bool send_zero(int wire) noexcept {
  const hapgrid_device_force zero{.force = {0, 0, 0}, .number = 0, .flags = 0};
  return ::send(wire, &zero, sizeof zero, MSG_NOSIGNAL | MSG_DONTWAIT) == sizeof zero;
}

bool AdapterGroup::has_ended() noexcept {
  pollfd ready[] = {{wire_, 0, 0}, {process_.get(), POLLIN, 0}};  // a negative one is passed over
  ::poll(ready, 2, 0);
  return ready[0].revents != 0 && (!process_ || ready[1].revents != 0);
}

void AdapterGroup::tell(int signal) noexcept {
  const pid_t session = ::getsid(leader_);  // another one's: the number was given to a new process
  if (session < 0 || session == session_) ::kill(-leader_, signal);
  if (process_ && ::getpgid(leader_) != leader_)  // it has left its group
    ::syscall(SYS_pidfd_send_signal, process_.get(), signal, nullptr, 0);
}

bool let_go(int wire, Family& family, std::chrono::milliseconds confirm_time) noexcept {
  const hapgrid_device_force last{
      .force = {0, 0, 0}, .number = kLastForce, .flags = HAPGRID_DEVICE_END};
  const auto deadline = Clock::now() + confirm_time;
  // Where the socket is full, the adapter is late, and hears of the zero by its end alone.
  (void)!::send(wire, &last, sizeof last, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (is_confirmed(wire, deadline)) return true;
  // One that has closed its socket may be about to end.
  if (ends_until(family, deadline)) return false;
  family.tell(SIGTERM);
  family.tell(SIGCONT);  // some of it may be stopped
  if (ends_until(family, Clock::now() + kTermTime)) return false;
  family.tell(SIGKILL);
  return false;
}

bool release(const std::vector<std::string>& command) noexcept {
  try {
    std::vector<std::string> words(command);
    words.emplace_back("--release");
    const std::vector<char*> arguments = argument_list(words);
    const pid_t pid = ::fork();
    if (pid < 0) return false;
    if (pid == 0) {
      ::setpgid(0, 0);
      restore_signals();
      const int nothing = ::open("/dev/null", O_RDWR);
      ::dup2(nothing, STDIN_FILENO);
      ::dup2(nothing, STDOUT_FILENO);
      ::execvp(arguments[0], arguments.data());
      for (;;) ::raise(SIGKILL);
    }
    // Neither a busy desktop nor a loop that spins must hold up the last word: the child itself
    // might not come to it.
    const sched_param priority{.sched_priority = kAdapterPriority};
    ::sched_setscheduler(pid, SCHED_FIFO | SCHED_RESET_ON_FORK, &priority);
    int status = 0;
    const auto deadline = Clock::now() + kReleaseTime;
    pid_t ended;
    while ((ended = ::waitpid(pid, &status, WNOHANG)) == 0 && Clock::now() < deadline)
      ::usleep(1000);
    if (ended == pid) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    ::kill(-pid, SIGKILL);
  } catch (const std::bad_alloc&) {
  }
  return false;
}

}  // namespace hapgrid
