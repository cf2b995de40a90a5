#include "libcore/device/process_guard.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <string_view>
#include <system_error>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/base/family.hpp"
#include "libcore/base/format.hpp"
#include "libcore/device/process_protocol.h"

namespace hapgrid {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

// Messages of the guard's socket: to start, to kill, the goodbye. Answers: 'k' and the adapter's
// process id, or how it ended; 'e' and why it cannot be started.
constexpr char kStart = 's', kKill = 'x', kBye = 'g', kOkay = 'k', kCannot = 'e';
constexpr auto kGrace = 2s;    // from the last message until the adapter has ended
constexpr auto kKilling = 1s;  // until all that was killed is gone
constexpr auto kPause = 5ms;
constexpr auto kEnding = 50ms;  // of an adapter that has closed its socket
// What the guard keeps.
constexpr int kWire = GuardProcess::kFirstKept;
constexpr int kAdaptersEnd = kWire + 1;
constexpr int kErrors = kWire + 2;  // standard error

/// What the child does between fork and exec. Writes errno to `failed` when it cannot.
[[noreturn]] void become_adapter(std::vector<char*>& arguments, pid_t guard, int failed) {
  begin_child(guard);
  restore_signals();
  ::dup2(kAdaptersEnd, STDIN_FILENO);
  ::dup2(kAdaptersEnd, STDOUT_FILENO);
  ::dup2(kErrors, STDERR_FILENO);
  ::execvp(arguments[0], arguments.data());
  const int error = errno;
  (void)!::write(failed, &error, sizeof error);
  ::raise(SIGKILL);
  for (;;) ::pause();
}

/// In the guard: the adapter and its descendants.
class Family {
 public:
  explicit Family(std::vector<std::string> command) : command_(std::move(command)) {
    become_subreaper();
  }

  /// @return the answer
  std::string start() {
    std::vector<char*> arguments;
    for (std::string& word : command_) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    int failed[2];
    if (adapter_ >= 0 || ::pipe2(failed, O_CLOEXEC) != 0) return kCannot + std::string("no pipe");
    const FileDescriptor heard(failed[0]);
    const pid_t guard = ::getpid();
    adapter_ = ::fork();
    if (adapter_ == 0) become_adapter(arguments, guard, failed[1]);
    int error = adapter_ < 0 ? errno : 0;
    // Only the adapter keeps its end, so that this program hears when it closes it.
    ::close(kAdaptersEnd);
    ::close(failed[1]);
    if (adapter_ > 0 && ::read(heard.get(), &error, sizeof error) <= 0)
      return kOkay + std::to_string(adapter_);
    return kCannot + std::generic_category().message(error);
  }

  /// The last message of the protocol, for when the program does not send it.
  void let_go() {
    const hapgrid_device_force last{.force = {0, 0, 0}, .number = ~0u, .end = 1};
    (void)!::send(kWire, &last, sizeof last, MSG_NOSIGNAL | MSG_DONTWAIT);
    end();
  }

  /// Waits until the adapter ended by itself, and kills what is left.
  void end() {
    const auto deadline = Clock::now() + kGrace;
    while (adapter_ >= 0 && !reap() && Clock::now() < deadline) std::this_thread::sleep_for(kPause);
    kill();
  }

  /// @return how the adapter had ended by itself
  std::string kill() {
    // Whoever closes its socket at its end is gone a moment later, which a busy machine makes
    // longer.
    pollfd wire{kWire, 0, 0};
    const bool is_closed = ::poll(&wire, 1, 0) > 0 && (wire.revents & POLLHUP) != 0;
    const auto soon = Clock::now() + (is_closed ? kEnding : kPause);
    while (adapter_ >= 0 && !reap() && Clock::now() < soon)
      std::this_thread::sleep_for(kPause / 10);
    std::string ended = how_;
    if (adapter_ > 0 && !ended_) ::kill(-adapter_, SIGKILL);  // where /proc is missing
    kill_family();
    ended_ = true;
    return ended;
  }

 private:
  /// @return whether the adapter has ended
  bool reap() {
    int status = 0;
    for (pid_t pid; (pid = ::waitpid(-1, &status, WNOHANG)) > 0;) {
      if (pid != adapter_) continue;
      how_ = how_it_ended(status);
      ended_ = true;
    }
    return ended_;
  }

  std::vector<std::string> command_;
  pid_t adapter_ = -1;
  bool ended_ = false;
  std::string how_;
};

/// What the guard does all its life.
void watch_over(int socket, Heart& heart, const std::vector<std::string>& command) {
  Family family(command);
  for (;;) {
    wait_for_message(socket, heart, [&family] { family.let_go(); });
    char message = 0;
    const ssize_t got = ::recv(socket, &message, 1, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return family.let_go();
    if (message == kBye) return family.end();
    const std::string answer = message == kStart ? family.start() : kOkay + family.kill();
    (void)!::send(socket, answer.data(), answer.size(), MSG_NOSIGNAL);
  }
}

}  // namespace

ProcessGuard::ProcessGuard(std::vector<std::string> command) {
  for (const std::string& word : command) name_ += (name_.empty() ? "process '" : " ") + word;
  name_ += "'";
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::system_error(errno, std::generic_category(), "the adapter's socket");
  wire_ = FileDescriptor(ends[0]);
  const FileDescriptor adapters(ends[1]);
  const int kept[] = {wire_.get(), adapters.get(), STDERR_FILENO};
  process_.emplace("hapgrid-guard", kept,
                   [&command](int socket, Heart& heart) { watch_over(socket, heart, command); });
  process_->set_patience(kGrace + 2 * kKilling);
}

void ProcessGuard::start() {
  char answer[256];
  const ssize_t got = process_->ask({&kStart, 1}, answer);
  if (got <= 0) throw DeviceError(format("{}: its guard process does not answer", name_));
  const std::string_view text(answer + 1, static_cast<std::size_t>(got) - 1);
  if (answer[0] == kCannot) throw DeviceError(format("{}: cannot be started: {}", name_, text));
  std::from_chars(text.data(), text.data() + text.size(), adapter_);
}

std::string ProcessGuard::kill() noexcept {
  char answer[256];
  const ssize_t got = process_->ask({&kKill, 1}, answer);
  return got > 1 ? std::string(answer + 1, static_cast<std::size_t>(got) - 1) : "";
}

void ProcessGuard::release() noexcept { (void)!::send(process_->socket(), &kBye, 1, MSG_NOSIGNAL); }

}  // namespace hapgrid
