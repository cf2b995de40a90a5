#include "libcore/device/guard_process.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

constexpr int kAnswerMs = 2000;
constexpr int kLookMs = 20;
constexpr int kIgnored[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2};

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// The child closes all other files, so that the reader of a pipe sees the end when this program
/// ends. The standard streams are /dev/null, so that no device gets their numbers.
void keep_only(std::vector<int> kept) {
  const int first = GuardProcess::kFirstKept - 1;  // the socket
  const int end = first + static_cast<int>(kept.size());
  const int nothing = ::open("/dev/null", O_RDWR);
  // First out of the way of each other.
  for (int& fd : kept) fd = ::fcntl(fd, F_DUPFD, end);
  for (int fd = 0; fd < first; ++fd) ::dup2(nothing, fd);
  for (std::size_t i = 0; i < kept.size(); ++i)
    ::dup3(kept[i], first + static_cast<int>(i), O_CLOEXEC);
  if (::syscall(SYS_close_range, static_cast<unsigned>(end), ~0u, 0u) != 0)
    for (int fd = end; fd < 65536; ++fd) ::close(fd);  // before Linux 5.9
}

/// A heart in memory that a child shares.
std::shared_ptr<Heart> shared_heart() {
  void* const memory =
      ::mmap(nullptr, sizeof(Heart), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) fail("the guard's memory");
  return {new (memory) Heart, [](Heart* heart) { ::munmap(heart, sizeof *heart); }};
}

}  // namespace

GuardProcess::GuardProcess(const char* name, std::span<const int> kept, const Life& life)
    : heart_(shared_heart()) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    fail("the guard's socket");
  socket_ = FileDescriptor(ends[0]);
  const FileDescriptor childs(ends[1]);
  pid_ = ::fork();
  if (pid_ < 0) fail("the guard process");
  if (pid_ > 0) return;
  ::setsid();
  for (const int signal : kIgnored) ::signal(signal, SIG_IGN);
  ::prctl(PR_SET_NAME, name);
  try {
    std::vector<int> all{childs.get()};
    all.insert(all.end(), kept.begin(), kept.end());
    keep_only(std::move(all));
    life(kFirstKept - 1, *heart_);
  } catch (...) {
  }
  // At once, because buffers and exit handlers belong to the parent.
  ::_exit(0);
}

GuardProcess::~GuardProcess() {
  socket_ = FileDescriptor();
  const auto deadline = std::chrono::steady_clock::now() + patience_;
  for (auto pause = 100us; ::waitpid(pid_, nullptr, WNOHANG) == 0;
       pause = std::min(2 * pause, 20'000us)) {
    if (std::chrono::steady_clock::now() >= deadline) return;  // it goes on alone
    std::this_thread::sleep_for(pause);
  }
}

ssize_t GuardProcess::ask(std::span<const char> message, std::span<char> answer) noexcept {
  if (::send(socket(), message.data(), message.size(), MSG_NOSIGNAL) < 0) return -1;
  pollfd ready{socket(), POLLIN, 0};
  int polled;
  do polled = ::poll(&ready, 1, kAnswerMs);
  while (polled < 0 && errno == EINTR);
  return polled > 0 ? ::recv(socket(), answer.data(), answer.size(), 0) : -1;
}

void wait_for_message(int socket, Heart& heart, const std::function<void()>& let_go) {
  int silent = 0;
  std::uint64_t last = heart.beats.load();
  pollfd ready{socket, POLLIN, 0};
  while (::poll(&ready, 1, kLookMs) <= 0) {
    const std::uint64_t now = heart.beats.load();
    silent = now == std::exchange(last, now) ? silent + 1 : 0;
    if (now == 0 || silent != kSilentLooks) continue;
    heart.let_go.store(true);  // first, so that no force comes after the zero
    let_go();
  }
}

void restore_signals() noexcept {
  for (const int signal : kIgnored) ::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

}  // namespace hapgrid
