#include "libcore/model/keeper_process.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "libcore/base/family.hpp"
#include "libcore/base/file.hpp"

namespace hapgrid {

namespace {

constexpr int kIgnored[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGTSTP, SIGUSR1, SIGUSR2};
constexpr int kSocket = 3;
constexpr int kLookMs = 1000;  // between looks for orphans that have ended
constexpr std::size_t kFiles = 4;

/// What a model process gets back.
class Signals {
 public:
  /// Those of the terminal are not for the keeper.
  Signals() {
    for (std::size_t i = 0; i < before_.size(); ++i) before_[i] = ::signal(kIgnored[i], SIG_IGN);
    ::signal(SIGCHLD, SIG_DFL);
  }
  /// A signal that this program was told to ignore (nohup) stays ignored, but not SIGPIPE.
  void restore() const {
    for (std::size_t i = 0; i < before_.size(); ++i)
      ::signal(kIgnored[i], kIgnored[i] != SIGPIPE && before_[i] == SIG_IGN ? SIG_IGN : SIG_DFL);
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
  }

 private:
  std::array<sighandler_t, std::size(kIgnored)> before_{};
};

/// The texts of a file, each with a zero behind it: the program, its folder, how many words, the
/// words, the environment.
std::vector<std::string> texts_of(int file) {
  std::string all;
  std::array<char, 1 << 14> buffer;
  for (ssize_t n;
       (n = ::pread(file, buffer.data(), buffer.size(), static_cast<off_t>(all.size()))) > 0;)
    all.append(buffer.data(), static_cast<std::size_t>(n));
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < all.size(); at += texts.back().size() + 1)
    texts.emplace_back(all.c_str() + at);
  return texts;
}

/// As execve() takes them.
std::vector<char*> pointers(std::vector<std::string>::iterator begin,
                            std::vector<std::string>::iterator end) {
  std::vector<char*> list;
  for (; begin != end; ++begin) list.push_back(begin->data());
  list.push_back(nullptr);
  return list;
}

class KeeperProcess {
 public:
  void serve() {
    for (;;) {
      pollfd ready{kSocket, POLLIN, 0};
      const bool asked = ::poll(&ready, 1, kLookMs) > 0;
      reap_orphans();
      if (asked && !answer()) return;
    }
  }

 private:
  /// False when nobody will ask any more.
  bool answer() {
    KeeperRequest request;
    std::vector<FileDescriptor> files;
    if (!receive(request, files)) return false;
    KeeperAnswer reply;
    switch (request.kind) {
      case KeeperRequest::Kind::kStart:
        reply = start(files);
        break;
      case KeeperRequest::Kind::kLook:
        reply.ended = has_ended(request.pid);
        break;
      case KeeperRequest::Kind::kEnd:
        reply.status = end(request.pid);
        reply.ended = true;
    }
    files.clear();
    return ::send(kSocket, &reply, sizeof reply, MSG_NOSIGNAL) == sizeof reply;
  }

  static bool receive(KeeperRequest& request, std::vector<FileDescriptor>& files) {
    iovec data{&request, sizeof request};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(kFiles * sizeof(int))> control;
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    ssize_t got;
    do got = ::recvmsg(kSocket, &message, MSG_CMSG_CLOEXEC);
    while (got < 0 && errno == EINTR);
    if (got != sizeof request) return false;
    for (cmsghdr* c = CMSG_FIRSTHDR(&message); c; c = CMSG_NXTHDR(&message, c)) {
      if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_RIGHTS) continue;
      std::array<int, kFiles> numbers{};
      const std::size_t bytes = std::min(c->cmsg_len - CMSG_LEN(0), sizeof numbers);
      std::memcpy(numbers.data(), CMSG_DATA(c), bytes);
      for (std::size_t i = 0; i < bytes / sizeof(int); ++i) files.emplace_back(numbers[i]);
    }
    return request.kind != KeeperRequest::Kind::kStart || files.size() == kFiles;
  }

  KeeperAnswer start(const std::vector<FileDescriptor>& files) {
    std::vector<std::string> texts = texts_of(files[0].get());
    const auto words = texts.begin() + 3;
    const auto variables = words + std::stol(texts[2]);
    const std::vector<char*> arguments = pointers(words, variables);
    const std::vector<char*> environment = pointers(variables, texts.end());
    int failed[2];
    if (::pipe2(failed, O_CLOEXEC) != 0) return {.error = errno};
    const FileDescriptor heard(failed[0]);
    FileDescriptor said(failed[1]);
    const pid_t keeper = ::getpid();
    const pid_t child = ::fork();
    if (child < 0) return {.error = errno};
    if (child == 0) {
      begin_child(keeper);
      signals_.restore();
      become(texts, arguments, environment, files, said.get());
    }
    said = FileDescriptor();
    int error = 0;
    ssize_t got;
    do got = ::read(heard.get(), &error, sizeof error);
    while (got < 0 && errno == EINTR);
    own_.push_back(child);
    if (got <= 0) return {.pid = child};
    end(child);
    return {.error = error};
  }

  /// Writes errno to `failed` when it cannot.
  [[noreturn]] static void become(const std::vector<std::string>& texts,
                                  const std::vector<char*>& arguments,
                                  const std::vector<char*>& environment,
                                  const std::vector<FileDescriptor>& files, int failed) {
    bool placed = texts[1].empty() || ::chdir(texts[1].c_str()) == 0;
    for (int fd = 0; fd < 3; ++fd)
      placed = placed && ::dup2(files[static_cast<std::size_t>(fd) + 1].get(), fd) >= 0;
    ::syscall(SYS_close_range, 3u, ~0u, CLOSE_RANGE_CLOEXEC);
    if (placed) ::execve(texts[0].c_str(), arguments.data(), environment.data());
    const int error = errno;
    (void)!::write(failed, &error, sizeof error);
    ::raise(SIGKILL);
    for (;;) ::pause();
  }

  bool is_own(pid_t pid) const { return std::find(own_.begin(), own_.end(), pid) != own_.end(); }

  bool has_ended(pid_t pid) const {
    siginfo_t info{};
    return !is_own(pid) ||
           ::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           info.si_pid != 0;
  }

  /// @return what waitpid() says
  int end(pid_t pid) {
    int status = 0;
    if (!is_own(pid)) return status;
    // The whole group, while its leader's number cannot be anybody else's.
    ::kill(-pid, SIGKILL);
    ::kill(pid, SIGKILL);
    while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    std::erase(own_, pid);
    return status;
  }

  void reap_orphans() const {
    for (const pid_t child : children())
      if (!is_own(child)) ::waitpid(child, nullptr, WNOHANG);
  }

  Signals signals_;
  std::vector<pid_t> own_;  // not the orphans of what they started
};

}  // namespace

void become_keeper(int socket, const std::function<void()>& at_the_end) {
  try {
    ::setsid();
    ::prctl(PR_SET_NAME, "hapgrid-keeper");
    become_subreaper();
    // Everything else is closed, so that the reader of a pipe sees the end when this program ends.
    const int nothing = ::open("/dev/null", O_RDWR);
    if (socket != kSocket) ::dup2(socket, kSocket);
    for (int fd = 0; fd < kSocket; ++fd) ::dup2(nothing, fd);
    if (::syscall(SYS_close_range, unsigned{kSocket + 1}, ~0u, 0u) != 0)
      for (int fd = kSocket + 1; fd < 65536; ++fd) ::close(fd);  // before Linux 5.9
    ::fcntl(kSocket, F_SETFD, FD_CLOEXEC);
    KeeperProcess().serve();
  } catch (...) {
  }
  try {
    kill_family();
    at_the_end();
  } catch (...) {
  }
  // At once, because buffers and exit handlers belong to the parent.
  ::_exit(0);
}

}  // namespace hapgrid
