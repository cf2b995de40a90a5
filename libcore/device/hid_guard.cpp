#include "libcore/device/hid_guard.hpp"

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

#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/device/hid_handle.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

// Messages of the socket, which keeps their boundaries. To the child: 'g', the goodbye, alone; or
// 'w', the path, a zero byte, and each report after its length (two bytes). Back: 'k' (an empty
// message would look like the end of the socket), or 'e' and why the device cannot be opened.
constexpr char kGoodbye = 'g', kWatch = 'w', kDone = 'k', kRefused = 'e';
constexpr std::size_t kMaxMessage = 1 << 16;
constexpr int kAnswerMs = 2000;
constexpr int kTries = 5;
constexpr auto kBetweenTries = 50ms;
constexpr int kLookMs = 20;

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

struct Watched {
  std::string path;
  std::vector<HidReport> stop;
  std::unique_ptr<HidHandle> handle;
};

/// @throw DeviceError
void take(std::string_view message, Watched& watched) {
  const std::size_t end = message.find('\0');
  if (end == message.npos) throw DeviceError("no path");
  const std::string path(message.substr(0, end));
  message.remove_prefix(end + 1);
  std::vector<HidReport> stop;
  while (message.size() >= 2) {
    const std::size_t size = static_cast<unsigned char>(message[0]) |
                             std::size_t{static_cast<unsigned char>(message[1])} << 8;
    const std::string_view bytes = message.substr(2, size);
    stop.emplace_back(bytes.begin(), bytes.end());
    message.remove_prefix(2 + bytes.size());
  }
  if (!watched.handle || watched.path != path) watched.handle = std::make_unique<HidHandle>(path);
  watched.path = path;
  watched.stop = std::move(stop);
}

/// Tries every report, also after one that the device did not take.
bool write_all(Watched& watched) {
  bool all = true;
  for (const HidReport& report : watched.stop) all = watched.handle->try_write(report) && all;
  return all;
}

void let_go(Watched& watched) {
  if (!watched.handle) return;
  for (int i = 0; i < kTries && !write_all(watched); ++i)
    std::this_thread::sleep_for(kBetweenTries);
}

/// Waits for a message, and lets go meanwhile if the heart stops.
void wait_for_message(int socket, HidHeart& heart, Watched& watched) {
  int silent = 0;
  std::uint64_t last = heart.beats.load();
  pollfd ready{socket, POLLIN, 0};
  while (::poll(&ready, 1, kLookMs) <= 0) {
    const std::uint64_t now = heart.beats.load();
    silent = now == std::exchange(last, now) ? silent + 1 : 0;
    if (now == 0 || silent != kHidSilentLooks) continue;
    heart.let_go.store(true);  // first, so that no force comes after the stop reports
    let_go(watched);
  }
}

/// What the child does all its life.
void guard(int socket, HidHeart& heart) {
  std::vector<char> buffer(kMaxMessage);
  Watched watched;
  for (;;) {
    wait_for_message(socket, heart, watched);
    const ssize_t got = ::recv(socket, buffer.data(), buffer.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return let_go(watched);
    if (buffer[0] == kGoodbye) return;
    std::string answer(1, kDone);
    try {
      take({buffer.data() + 1, static_cast<std::size_t>(got) - 1}, watched);
    } catch (const std::exception& e) {
      answer = kRefused + std::string(e.what());
    }
    (void)!::send(socket, answer.data(), answer.size(), MSG_NOSIGNAL);
  }
}

[[noreturn]] void become_guard(int socket, HidHeart& heart) {
  ::setsid();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2})
    ::signal(signal, SIG_IGN);
  ::prctl(PR_SET_NAME, "hapgrid-guard");
  // The child closes all files, so that the reader of a pipe sees the end when this program ends.
  // The socket becomes 3. The standard streams are /dev/null, so that no device gets their numbers.
  const int nothing = ::open("/dev/null", O_RDWR);
  if (socket != 3) ::dup2(socket, 3);
  for (int fd = 0; fd < 3; ++fd) ::dup2(nothing, fd);
  if (::syscall(SYS_close_range, 4u, ~0u, 0u) != 0)
    for (int fd = 4; fd < 65536; ++fd) ::close(fd);  // before Linux 5.9
  ::fcntl(3, F_SETFD, FD_CLOEXEC);
  try {
    guard(3, heart);
  } catch (...) {
  }
  // At once, because buffers and exit handlers belong to the parent.
  ::_exit(0);
}

/// A heart in memory that a child shares.
std::shared_ptr<HidHeart> shared_heart() {
  void* const memory =
      ::mmap(nullptr, sizeof(HidHeart), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) fail("the guard's memory");
  return {new (memory) HidHeart, [](HidHeart* heart) { ::munmap(heart, sizeof *heart); }};
}

}  // namespace

HidGuard::HidGuard() : heart_(shared_heart()) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    fail("the guard's socket");
  socket_ = FileDescriptor(ends[0]);
  const FileDescriptor childs(ends[1]);
  pid_ = ::fork();
  if (pid_ < 0) fail("the guard process");
  if (pid_ == 0) become_guard(childs.get(), *heart_);
}

HidGuard::~HidGuard() {
  socket_ = FileDescriptor();
  const auto deadline = std::chrono::steady_clock::now() + 1s;
  for (auto pause = 100us; ::waitpid(pid_, nullptr, WNOHANG) == 0;
       pause = std::min(2 * pause, 20'000us)) {
    if (std::chrono::steady_clock::now() >= deadline) return;  // it goes on alone
    std::this_thread::sleep_for(pause);
  }
}

void HidGuard::watch(const std::string& path, const std::vector<HidReport>& stop) {
  std::string message = kWatch + path + '\0';
  for (const HidReport& report : stop) {
    if (report.size() > kMaxHidReport) throw DeviceError(path + ": a stop report is too long");
    message += {static_cast<char>(report.size() & 255), static_cast<char>(report.size() >> 8)};
    message.append(report.begin(), report.end());
  }
  if (message.size() > kMaxMessage || path.find('\0') != path.npos)
    throw DeviceError(path + ": too many stop reports for the guard process");
  char answer[512];
  ssize_t got = -1;
  if (::send(socket_.get(), message.data(), message.size(), MSG_NOSIGNAL) >= 0) {
    pollfd ready{socket_.get(), POLLIN, 0};
    int polled;
    do polled = ::poll(&ready, 1, kAnswerMs);
    while (polled < 0 && errno == EINTR);
    if (polled > 0) got = ::recv(socket_.get(), answer, sizeof answer, 0);
  }
  if (got <= 0) throw DeviceError(path + ": the guard process does not answer");
  if (answer[0] != kDone)
    throw DeviceError("the guard process: " +
                      std::string(answer + 1, static_cast<std::size_t>(got) - 1));
}

void HidGuard::release() noexcept { (void)!::send(socket_.get(), &kGoodbye, 1, MSG_NOSIGNAL); }

}  // namespace hapgrid
