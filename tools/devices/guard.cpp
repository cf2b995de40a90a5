// hapgrid-guard: starts an adapter, and sees to it that the motors hear zero force last.
//
// Problem. An adapter that hangs holds the hand with the last force; one that has children or
// became a daemon outlives its parent; and play may be killed, stopped or starved before it could
// say the last word. Choice: a process of its own, which play starts with a name of its own, so
// that what ends play does not end it. It is the adapter's parent and, by PR_SET_CHILD_SUBREAPER,
// the heir of all that descends from it. It has a copy of play's end of the adapter's socket, and
// sleeps until play says something, is gone, or is silent for too long:
//
// | play                                     | the guard                                        |
// |------------------------------------------|--------------------------------------------------|
// | says that it ends, or is gone            | ends the adapter as let_go.hpp says              |
// | is silent for 0.1 s                      | sends zero force, which needs no answer          |
// | ... and the adapter does not take it     | ends the adapter                                 |
// |     from its socket within 0.1 s         |                                                  |
// | is silent for 0.5 s                      | ends the adapter: play has lost its device       |
// | the adapter closes its socket            | ends what is left of it                          |
//
// When the guard itself is killed, play hears it by its socket and ends as let_go.hpp says; when
// both are gone, the adapter sees the end of its socket. At a real-time priority, the kernel ends a
// guard or an adapter that spins (RLIMIT_RTTIME).
// Alternatives: a thread or a fork of play (what kills play kills it, too), a control group (it
// needs rights that a user may not have), PR_SET_PDEATHSIG (it would end an adapter before it could
// let go).
#include <fcntl.h>
#include <linux/sockios.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "libcore/base/child.hpp"
#include "libcore/device/guard_words.hpp"
#include "libcore/device/let_go.hpp"

using namespace hapgrid;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

constexpr auto kSilence = 100ms, kTaken = 200ms, kLost = 500ms;  // since the last beat
constexpr std::size_t kLongestCommand = 1 << 16;
/// The kernel ends who computes for so long at a real-time priority and never waits: whoever spins
/// would keep all others from its processor. An adapter has been asked and told to let go before,
/// by let_go.hpp, since it may compute for 0.12 s and have no --release.
constexpr auto kBusyGuard = 50ms, kBusyAdapter = 400ms;
static_assert(kBusyAdapter > kSilence + kConfirmTime + kTermTime);

/// @param longest processor time between two waits; 0: as much as the system grants
void limit_busy_time(std::chrono::microseconds longest) {
  rlimit limit;
  if (::getrlimit(RLIMIT_RTTIME, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  if (longest > 0us) limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, longest / 1us);
  ::setrlimit(RLIMIT_RTTIME, &limit);
}

/// Before anything is started: no signal, no file of play's, no lack of memory later.
void take_precautions() {
  for (int signal = 1; signal < NSIG; ++signal)
    if (signal != SIGCHLD && signal != SIGXCPU) ::signal(signal, SIG_IGN);
  ::syscall(SYS_close_range, kGuardAdaptersEnd + 1u, ~0u, 0u);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const sched_param priority{.sched_priority = kGuardPriority};
  ::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &priority);  // where it is granted
  ::mlockall(MCL_CURRENT);
}

void say(char word, const std::string& text = "") {
  const std::string message = word + text;
  (void)!::send(kGuardSocket, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

/// The words of the first message.
std::vector<std::string> read_command() {
  std::vector<char> text(kLongestCommand);
  const ssize_t got = ::recv(kGuardSocket, text.data(), text.size(), 0);
  std::vector<std::string> words;
  const auto end = text.begin() + std::max<ssize_t>(got, 0);
  for (auto at = text.begin(); at != end;) {
    const auto zero = std::find(at, end, '\0');
    words.emplace_back(at, zero);
    at = zero == end ? end : zero + 1;
  }
  return words;
}

/// What the child does between fork and exec. Writes errno to `failed` when it cannot.
[[noreturn]] void become_adapter(char* const* arguments, int failed) {
  ::setpgid(0, 0);
  restore_signals();
  limit_busy_time(kBusyAdapter);  // an adapter that has good reasons may raise it
  ::dup2(kGuardAdaptersEnd, STDIN_FILENO);
  ::dup2(kGuardAdaptersEnd, STDOUT_FILENO);
  ::close(kGuardAdaptersEnd);
  ::execvp(arguments[0], arguments);
  const int error = errno;
  (void)!::write(failed, &error, sizeof error);
  ::_exit(127);
}

/// @return its process id @throw std::system_error
pid_t start(std::vector<std::string> command) {
  const std::vector<char*> arguments = argument_list(command);
  int failed[2];
  if (::pipe2(failed, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category());
  const FileDescriptor heard(failed[0]);
  FileDescriptor said(failed[1]);
  const pid_t adapter = ::fork();
  if (adapter == 0) become_adapter(arguments.data(), said.get());
  int error = adapter < 0 ? errno : 0;
  ::close(kGuardAdaptersEnd);  // the adapter's alone: whoever reads hears when it closes it
  said = FileDescriptor();
  if (adapter < 0 || ::read(heard.get(), &error, sizeof error) > 0)
    throw std::system_error(error, std::generic_category());
  return adapter;
}

/// Whether a signal to a living leader's process group reaches it.
bool is_led(pid_t pid) {
  const pid_t group = ::getpgid(pid);
  return group > 0 && group != ::getpgrp() && ::kill(group, 0) == 0;
}

/// A signal for each child of a process, and for their groups and children in turn.
/// @return a number that another family has not, 0 for none
std::uint64_t signal_family(pid_t parent, int signal) {
  char name[64];  // where memory is scarce, too
  std::snprintf(name, sizeof name, "/proc/%d/task/%d/children", parent, parent);
  std::FILE* const file = std::fopen(name, "re");
  std::uint64_t family = 0;
  for (int pid = 0; file && std::fscanf(file, "%d", &pid) == 1;) {
    // Whoever lets go of the device must not wait for a processor meanwhile.
    const sched_param priority{.sched_priority = kAdapterPriority};
    if (signal == SIGTERM) ::sched_setscheduler(pid, SCHED_FIFO | SCHED_RESET_ON_FORK, &priority);
    // A signal for a group reaches it as a whole: who forks meanwhile cannot escape. A second
    // SIGTERM could end who has begun to let go.
    ::kill(-pid, signal);
    if (signal != SIGTERM || !is_led(pid)) ::kill(pid, signal);
    family += (std::uint64_t{1} << 40) +
              static_cast<std::uint64_t>(pid) * static_cast<std::uint64_t>(pid) +
              signal_family(pid, signal);
  }
  if (file) std::fclose(file);
  return family;
}

/// All that descends from this process.
class Descendants : public Family {
 public:
  /// @param first the adapter as it was started
  explicit Descendants(pid_t first) : first_(first) {}

  bool has_ended() noexcept override {
    int status = 0;
    pid_t ended;
    while ((ended = ::waitpid(-1, &status, WNOHANG)) > 0)
      if (ended == first_ && !told_) status_ = status;
    return ended < 0 && errno == ECHILD;
  }

  void tell(int signal) noexcept override {
    told_ = true;
    signal_family(::getpid(), signal);
  }

  /// Stops them until no new one appears, then kills them, and waits for their end, however long
  /// the kernel takes.
  void kill() {
    told_ = true;
    std::uint64_t now = 0, before;
    do {
      before = std::exchange(now, signal_family(::getpid(), SIGSTOP));
      has_ended();
    } while (now != before);
    for (auto pause = 1ms; signal_family(::getpid(), SIGKILL) > 0;
         pause = std::min(2 * pause, 50ms)) {
      const auto until = Clock::now() + pause;
      while (!has_ended() && Clock::now() < until) ::usleep(200);
    }
  }

  /// How the first one ended before anybody was told to; empty when it had not.
  std::string how() const { return status_ ? how_it_ended(*status_) : ""; }

 private:
  pid_t first_;
  bool told_ = false;
  std::optional<int> status_;
};

class Guard {
 public:
  explicit Guard(std::vector<std::string> command)
      : command_(std::move(command)), adapter_(start(command_)), family_(adapter_) {}

  pid_t adapter() const { return adapter_; }

  /// Until play says that it ends, or has to. @return the exit code
  int watch() {
    limit_busy_time(kBusyGuard);
    for (;;) {
      pollfd ready[] = {{kGuardSocket, POLLIN, 0}, {kGuardWire, 0, 0}};
      if (::poll(ready, 2, milliseconds_to_act()) < 0) continue;
      if (ready[0].revents != 0) {
        if (!heard()) return end(kGuardAsked);
      } else if (ready[1].revents != 0) {
        return end(kGuardClosed);
      } else if (!is_well()) {
        return end(taken_ ? kGuardStood : kGuardDeaf);
      }
    }
  }

 private:
  int milliseconds_to_act() const {
    if (!armed_) return -1;
    const auto at = last_beat_ + (!zeroed_ ? kSilence : !taken_ ? kTaken : kLost);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(at - Clock::now());
    return static_cast<int>(std::max<std::int64_t>(left.count(), 0));
  }

  /// A message of play's. @return whether it goes on
  bool heard() {
    char word = 0;
    const ssize_t got = ::recv(kGuardSocket, &word, 1, MSG_DONTWAIT);
    if (got < 0) return errno == EINTR || errno == EAGAIN;
    if (got == 0 || word == kGuardEnd) return false;
    if (word == kGuardReleases) {
      releases_ = true;
      return true;
    }
    armed_ = true;
    zeroed_ = taken_ = false;
    last_beat_ = Clock::now();
    return true;
  }

  /// What a silent play has to do. @return whether play may still come back
  bool is_well() {
    if (!armed_) return true;
    const auto silent = Clock::now() - last_beat_;
    if (silent >= kSilence && !std::exchange(zeroed_, true)) send_zero(kGuardWire);
    if (silent >= kTaken && !taken_) {
      int unread = 0;
      taken_ = ::ioctl(kGuardWire, SIOCOUTQ, &unread) != 0 || unread == 0;
      if (!taken_) return false;
    }
    return silent < kLost;
  }

  int end(char why) {
    limit_busy_time(0us);  // the end of a large family may take longer
    say(kGuardHeard);
    const auto patience = why == kGuardDeaf ? 0ms : kConfirmTime;
    const bool confirmed = let_go(kGuardWire, family_, patience);
    say(confirmed ? kGuardConfirmed : kGuardForced, why + family_.how());
    const auto until = Clock::now() + kLingerTime;
    while (confirmed && !family_.has_ended() && Clock::now() < until) ::usleep(1000);
    family_.kill();
    return confirmed || (releases_ && release(command_)) ? 0 : 1;
  }

  std::vector<std::string> command_;
  pid_t adapter_;
  Descendants family_;
  bool armed_ = false;  // play has begun: forces may come
  bool releases_ = false;
  bool zeroed_ = false, taken_ = false;  // since the last beat
  Clock::time_point last_beat_;
};

}  // namespace

int main() {
  take_precautions();
  std::vector<std::string> command = read_command();
  if (command.empty()) return 0;
  try {
    Guard guard(std::move(command));
    say(kGuardStarted, std::to_string(guard.adapter()));
    return guard.watch();
  } catch (const std::system_error& e) {
    say(kGuardCannot, e.code().message());
  } catch (const std::bad_alloc&) {
    say(kGuardCannot, "out of memory");
  }
  Descendants(-1).kill();
  return 0;
}
