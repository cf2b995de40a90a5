#include "libcore/model/keeper.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>

namespace hapgrid {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr std::string_view kVariable = "HAPGRID_MODEL_OF=";
constexpr int kRounds = 200;  // a family that starts faster than it is killed is left in the end
constexpr auto kBetweenRounds = 2ms;

/// What a process was started with; empty when it is another user's, or a zombie.
std::string environment_of(pid_t pid) {
  const std::string name = "/proc/" + std::to_string(pid) + "/environ";
  const FileDescriptor file(::open(name.c_str(), O_RDONLY | O_CLOEXEC));
  std::string text;
  std::array<char, 1 << 14> buffer;
  for (ssize_t n; file && (n = ::read(file.get(), buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  return text;
}

std::optional<pid_t> pid_of(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename();
  pid_t pid = 0;
  const auto read = std::from_chars(name.data(), name.data() + name.size(), pid);
  if (read.ec != std::errc() || read.ptr != name.data() + name.size()) return std::nullopt;
  return pid;
}

/// @return whether there was one
bool kill_once(const std::string& mark) {
  bool any = false;
  std::error_code ignored;
  for (fs::directory_iterator entry("/proc", ignored), end; entry != end;
       entry.increment(ignored)) {
    const std::optional<pid_t> pid = pid_of(*entry);
    if (!pid || *pid == ::getpid()) continue;
    // Held before its environment is read: its number cannot become another process' meanwhile.
    const FileDescriptor process(static_cast<int>(::syscall(SYS_pidfd_open, *pid, 0)));
    if (!process || environment_of(*pid).find(mark) == std::string::npos) continue;
    any = ::syscall(SYS_pidfd_send_signal, process.get(), SIGKILL, nullptr, 0) == 0 || any;
  }
  return any;
}

[[noreturn]] void become_keeper(int alive, const std::string& mark) {
  ::setsid();  // signals of the terminal are not for the keeper
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2})
    ::signal(signal, SIG_IGN);
  ::prctl(PR_SET_NAME, "hapgrid-keeper");
  // Everything else is closed, so that the reader of a pipe sees the end when this program ends.
  const int nothing = ::open("/dev/null", O_RDWR);
  if (alive != 3) ::dup2(alive, 3);
  for (int fd = 0; fd < 3; ++fd) ::dup2(nothing, fd);
  if (::syscall(SYS_close_range, 4u, ~0u, 0u) != 0)
    for (int fd = 4; fd < 65536; ++fd) ::close(fd);  // before Linux 5.9
  char none;
  while (::read(3, &none, 1) < 0 && errno == EINTR) {
  }
  try {
    kill_marked(mark);
  } catch (...) {
  }
  // At once, because buffers and exit handlers belong to the parent.
  ::_exit(0);
}

}  // namespace

void kill_marked(const std::string& mark) {
  for (int round = 0; round < kRounds && kill_once(mark); ++round)
    std::this_thread::sleep_for(kBetweenRounds);
}

Keeper::Keeper()
    : mark_("/" + std::to_string(::getpid()) + "-" +
            std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()) + "/") {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "the keeper's pipe");
  const FileDescriptor keepers(ends[0]);
  alive_ = FileDescriptor(ends[1]);
  pid_ = ::fork();
  if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "the keeper process");
  if (pid_ > 0) return;
  ::close(alive_.get());
  become_keeper(keepers.get(), mark_);
}

Keeper::~Keeper() {
  alive_ = FileDescriptor();
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::vector<std::string> Keeper::environment(const std::string& mark) {
  std::vector<std::string> variables;
  std::string ours = std::string(kVariable) + mark;
  for (char** variable = ::environ; *variable; ++variable) {
    const std::string_view text(*variable);
    if (text.starts_with(kVariable))
      ours += text.substr(kVariable.size());
    else
      variables.emplace_back(text);
  }
  variables.push_back(std::move(ours));
  return variables;
}

}  // namespace hapgrid
