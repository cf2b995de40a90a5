#include "libcore/device/process_guard.hpp"

#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "libcore/base/child.hpp"
#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/device/guard_words.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

constexpr auto kStartTime = 2s;    // for the guard, and the start of the adapter
constexpr auto kHeardTime = 50ms;  // until a guard that can act has said so
constexpr auto kEndTime = kConfirmTime + kTermTime + 200ms;  // until it must have told how it ended
constexpr auto kPatience = kLingerTime + kReleaseTime;       // until it must have ended

/// The ends of a socket. @param what it is, for messages @throw std::system_error
std::array<FileDescriptor, 2> open_socket(const char* what) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::system_error(errno, std::generic_category(), what);
  return {FileDescriptor(ends[0]), FileDescriptor(ends[1])};
}

/// @param files become the guard's descriptors 0, 1 and 3. @throw DeviceError
pid_t spawn(const std::string& program, const int (&files)[3]) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, files[0], kGuardSocket);
  ::posix_spawn_file_actions_adddup2(&actions, files[1], kGuardWire);
  ::posix_spawn_file_actions_adddup2(&actions, files[2], kGuardAdaptersEnd);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
  // Its name alone: who ends what has the words of play's command line must not end it.
  char name[] = "hapgrid-guard";
  char* const arguments[] = {name, nullptr};
  pid_t pid = -1;
  const int error = ::posix_spawn(&pid, program.c_str(), &actions, &attributes, arguments, environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw DeviceError(format("the guard process {} cannot be started: {}", program,
                             std::generic_category().message(error)));
  return pid;
}

/// Reads a message of the guard's. @return it, empty when none came in time, or the guard is gone
std::string receive(int socket, std::chrono::milliseconds patience) noexcept {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  char text[512];
  for (;;) {
    pollfd ready{socket, POLLIN, 0};
    const int polled = ::poll(&ready, 1, milliseconds_until(deadline));
    if (polled < 0 && errno == EINTR) continue;
    if (polled <= 0) return "";
    const ssize_t got = ::recv(socket, text, sizeof text, MSG_DONTWAIT);
    if (got > 0) return std::string(text, static_cast<std::size_t>(got));
    // A guard that has gone with a beat unread resets the socket once; its last word comes then.
    if (got == 0 || (errno != ECONNRESET && errno != EINTR)) return "";
  }
}

}  // namespace

ProcessGuard::ProcessGuard(AdapterProgram program) : program_(std::move(program)) {
  // Where this program was started with SIGCHLD ignored, the kernel would forget how a child ended.
  ::signal(SIGCHLD, SIG_DFL);
  auto [wire, adapters_end] = open_socket("the adapter's socket");
  auto [socket, guards_end] = open_socket("the guard's socket");
  guard_ = spawn(program_.guard, {guards_end.get(), wire.get(), adapters_end.get()});
  wire_ = std::move(wire);
  socket_ = std::move(socket);
  guards_end = FileDescriptor();
  adapters_end = FileDescriptor();
  try {
    const std::string answer = ask_guard();
    const std::string_view text = std::string_view(answer).substr(answer.empty() ? 0 : 1);
    if (answer.empty()) throw DeviceError(format("{}: its guard process does not answer", name()));
    if (answer[0] != kGuardStarted)
      throw DeviceError(format("{}: cannot be started: {}", name(), text));
    pid_t adapter = -1;
    std::from_chars(text.data(), text.data() + text.size(), adapter);
    group_.emplace(wire_.get(), adapter);
  } catch (...) {
    socket_ = FileDescriptor();  // which ends the adapter, if there is one
    wait_for_guard();
    throw;
  }
}

ProcessGuard::~ProcessGuard() {
  end();
  socket_ = FileDescriptor();
  wait_for_guard();
}

/// Tells it the adapter's command.
std::string ProcessGuard::ask_guard() {
  std::string words;
  for (const std::string& word : program_.command) words += word + '\0';
  if (::send(socket_.get(), words.data(), words.size(), MSG_NOSIGNAL) < 0)
    throw std::system_error(errno, std::generic_category(), "the guard process");
  return receive(socket_.get(), kStartTime);
}

void ProcessGuard::set_releases() noexcept {
  releases_ = true;
  (void)!::send(socket_.get(), &kGuardReleases, 1, MSG_NOSIGNAL | MSG_DONTWAIT);
}

bool ProcessGuard::beat() noexcept {
  // A guard that stands still hears it later.
  return ::send(socket_.get(), &kGuardBeat, 1, MSG_NOSIGNAL | MSG_DONTWAIT) == 1 || errno == EAGAIN;
}

bool ProcessGuard::end() noexcept {
  if (std::exchange(ended_, true)) return confirmed_;
  send_zero(wire());  // at once, whatever the guard does
  (void)!::send(socket_.get(), &kGuardEnd, 1, MSG_NOSIGNAL | MSG_DONTWAIT);
  const bool acts = !receive(socket_.get(), kHeardTime).empty();
  const std::string told = acts ? receive(socket_.get(), kEndTime) : "";
  if (told.size() < 2) {  // it is dead or stands still
    confirmed_ = let_go(wire(), *group_);
    ::kill(guard_, SIGKILL);
    wait_for_guard();
    released_ = !confirmed_ && releases_ && release(program_.command);
  } else {
    confirmed_ = told[0] == kGuardConfirmed;
    why_ = told[1];
    how_ = told.substr(2);
    if (!confirmed_) wait_for_guard();
  }
  return confirmed_;
}

void ProcessGuard::wait_for_guard() noexcept {
  if (guard_ < 0) return;
  int status = 0;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  pid_t ended;
  for (auto pause = 100us; (ended = ::waitpid(guard_, &status, WNOHANG)) == 0;
       pause = std::min(2 * pause, 20'000us)) {
    if (std::chrono::steady_clock::now() >= deadline) return;  // it goes on alone
    std::this_thread::sleep_for(pause);
  }
  guard_ = -1;
  released_ =
      ended > 0 && !confirmed_ && releases_ && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace hapgrid
