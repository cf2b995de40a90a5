#include "libcore/model/process.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>
#include <utility>

#include "libcore/base/child.hpp"
#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/signals.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace {

constexpr int kStandardStreams = 3;

[[noreturn]] void fail_by_errno(const std::string& what = "a model process") {
  throw std::system_error(errno, std::generic_category(), what);
}

/// The ends of a pipe: for reading and for writing.
std::array<FileDescriptor, 2> open_pipe() {
  int fds[2];
  if (::pipe2(fds, O_CLOEXEC) != 0) fail_by_errno();
  std::array<FileDescriptor, 2> ends{FileDescriptor(fds[0]), FileDescriptor(fds[1])};
  // Where this program was started without standard streams, the pipe has got their numbers, and
  // the child would overwrite it.
  for (FileDescriptor& end : ends)
    if (end.get() < kStandardStreams) {
      end = FileDescriptor(::fcntl(end.get(), F_DUPFD_CLOEXEC, kStandardStreams));
      if (!end) fail_by_errno();
    }
  return ends;
}

/// What the child does between vfork and exec, where only calls that are safe in a signal handler
/// are allowed, and all memory is this program's. Writes errno to `failed` when it cannot become
/// the program.
[[noreturn]] void become(const char* file, char* const* arguments, const char* directory,
                         const int (&streams)[kStandardStreams], int failed, pid_t parent) {
  begin_child(parent);
  // A signal that this program was told to ignore (nohup) stays ignored, but not SIGPIPE.
  ::signal(SIGPIPE, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::pthread_sigmask(SIG_SETMASK, &none, nullptr);
  bool is_ready = *directory == '\0' || ::chdir(directory) == 0;
  for (int fd = 0; fd < kStandardStreams; ++fd) is_ready = is_ready && ::dup2(streams[fd], fd) >= 0;
  ::syscall(SYS_close_range, unsigned{kStandardStreams}, ~0u, CLOSE_RANGE_CLOEXEC);
  if (is_ready) ::execv(file, arguments);
  const int error = errno;
  (void)!::write(failed, &error, sizeof error);
  ::kill(::getpid(), SIGKILL);  // not raise(), whose thread may be the one that waits
  for (;;) ::pause();
}

Child start_child(const std::string& file, std::vector<std::string> words,
                  const std::string& directory) {
  const std::vector<char*> arguments = argument_list(words);
  auto [childs_input, input] = open_pipe();
  auto [output, childs_output] = open_pipe();
  auto [errors, childs_errors] = open_pipe();
  auto [failed, childs_failed] = open_pipe();
  const int streams[] = {childs_input.get(), childs_output.get(), childs_errors.get()};
  const pid_t parent = ::getpid();
  // fork() would copy the tables of all memory, which play has locked: its loop would have to wait.
  const pid_t pid = ::vfork();
  if (pid < 0) fail_by_errno();
  if (pid == 0)
    become(file.c_str(), arguments.data(), directory.c_str(), streams, childs_failed.get(), parent);
  childs_failed = FileDescriptor();  // exec closes the child's own
  int error = 0;
  ssize_t got;
  do got = ::read(failed.get(), &error, sizeof error);
  while (got < 0 && errno == EINTR);
  if (got <= 0) return {pid, std::move(input), std::move(output), std::move(errors)};
  while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
  }
  throw Error(format("cannot be started in {}: {}",
                     (std::filesystem::current_path() / directory).string(),
                     std::generic_category().message(error)));
}

}  // namespace

Launcher::Launcher() : thread_([this](const std::stop_token& stop) { run(stop); }) {
  // Where this program was started with SIGCHLD ignored, the kernel would forget how a child ended.
  ::signal(SIGCHLD, SIG_DFL);
}

Child Launcher::start(const std::string& file, const std::vector<std::string>& words,
                      const std::string& directory) {
  std::packaged_task<Child()> task([&] { return start_child(file, words, directory); });
  std::future<Child> child = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  has_task_.notify_one();
  return child.get();
}

void Launcher::run(const std::stop_token& stop) {
  // This program's signals are for its other threads. No handler runs in a child before exec.
  const BlockedSignals blocked;
  for (;;) {
    std::unique_lock lock(mutex_);
    if (!has_task_.wait(lock, stop, [this] { return !tasks_.empty(); })) return;
    std::packaged_task<Child()> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task();
  }
}

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kReadBytes = 1 << 16;
constexpr std::size_t kErrorLineBytes = 4096;  // of a line of standard error that is remembered
constexpr auto kGrace = 2s;                    // from the end of the child's input to SIGKILL
constexpr auto kEndingGrace = 1s;              // from the end of its output to its own end

/// The file to execute. It is looked up here because hardly any call is allowed between vfork and
/// exec.
fs::path find_program(const std::string& program, const fs::path& directory) {
  if (program.find('/') != std::string::npos) return fs::current_path() / directory / program;
  const char* path = std::getenv("PATH");
  std::string_view left = path ? path : "/usr/local/bin:/usr/bin:/bin";
  while (!left.empty()) {
    const std::size_t colon = left.find(':');
    const std::string_view entry = left.substr(0, colon);
    left.remove_prefix(colon == left.npos ? left.size() : colon + 1);
    fs::path file = fs::absolute(fs::path(entry) / program);
    std::error_code ignored;
    if (!entry.empty() && fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0)
      return file;
  }
  throw Error(format("cannot be started: no program {} in PATH", program));
}

void set_nonblocking(int fd) {
  if (::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK) != 0) fail_by_errno("a pipe");
}

}  // namespace

ChildProcess::ChildProcess(Launcher& launcher, const std::vector<std::string>& command,
                           const fs::path& directory)
    : program_(find_program(command.at(0), directory).string()),
      child_(launcher.start(program_, command, directory.string())),
      buffer_(kReadBytes, '\0') {
  for (const FileDescriptor* end : {&child_.input, &child_.output, &child_.errors})
    set_nonblocking(end->get());
}

ChildProcess::~ChildProcess() { end(); }

ChildProcess::Event ChildProcess::pump(Clock::time_point deadline) {
  // Lines that next_line() has returned are removed here: nobody uses them any more.
  if (read_ > 0) {
    in_.erase(0, read_);
    scanned_ -= read_;
    read_ = 0;
  }
  for (;;) {
    while (written_ < out_.size()) {
      const ssize_t n = ::write(child_.input.get(), out_.data() + written_, out_.size() - written_);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && errno != EAGAIN) return Event::kEnded;
      if (n < 0) break;
      written_ += static_cast<std::size_t>(n);
    }
    if (written_ == out_.size()) {
      out_.clear();
      written_ = 0;
    }
    pollfd fds[3] = {{child_.output.get(), POLLIN, 0},
                     {child_.errors.get(), POLLIN, 0},
                     {child_.input.get(), POLLOUT, 0}};
    const int ready = ::poll(fds, out_.empty() ? 2 : 3, milliseconds_until(deadline));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) fail_by_errno("a pipe from a model process");
    if (ready == 0) {
      if (Clock::now() < deadline) continue;
      return Event::kTimeout;
    }
    if (fds[1].revents != 0) pass_errors_on();
    if (fds[0].revents == 0) {
      if (Clock::now() >= deadline) return Event::kTimeout;  // standard error gives no more time
      continue;
    }
    ssize_t n;
    do n = ::read(child_.output.get(), buffer_.data(), buffer_.size());
    while (n < 0 && errno == EINTR);
    if (n > 0) {
      in_.append(buffer_.data(), static_cast<std::size_t>(n));
      return Event::kMoved;
    }
    if (n == 0 || errno != EAGAIN) return Event::kEnded;
  }
}

bool ChildProcess::next_line(std::string_view& line) {
  const std::size_t end = in_.find('\n', scanned_);
  if (end == std::string::npos) {
    scanned_ = in_.size();
    return false;
  }
  line = std::string_view(in_).substr(read_, end - read_);
  read_ = scanned_ = end + 1;
  return true;
}

std::uint64_t ChildProcess::memory_bytes() const {
  return child_.pid > 0 ? memory_of_group(child_.pid) : 0;
}

void ChildProcess::hang_up() { child_.input = FileDescriptor(); }

/// Its process id stays valid: its end has not been waited for.
bool ChildProcess::has_ended() const {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(child_.pid), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
         info.si_pid != 0;
}

bool ChildProcess::wait_until(Clock::time_point deadline) {
  // Most end at once when their input does.
  for (auto pause = 100us; !has_ended(); pause = std::min(2 * pause, 20'000us)) {
    if (Clock::now() >= deadline) return false;
    // A child that still writes must not wait for a reader.
    char ignored[4096];
    if (child_.output)
      while (::read(child_.output.get(), ignored, sizeof ignored) > 0) {
      }
    pass_errors_on();
    std::this_thread::sleep_for(pause);
  }
  return true;
}

/// Reads once from the child's standard error and copies it. Returns whether there may be more.
bool ChildProcess::pass_errors_on() {
  if (!child_.errors) return false;
  char text[1 << 14];
  ssize_t n;
  do n = ::read(child_.errors.get(), text, sizeof text);
  while (n < 0 && errno == EINTR);
  if (n < 0 && errno == EAGAIN) return false;
  if (n <= 0) {
    child_.errors = FileDescriptor();
    return false;
  }
  write_errors({text, static_cast<std::size_t>(n)});
  return true;
}

/// Copies it to standard error, where an error is ignored, and remembers its last line.
void ChildProcess::write_errors(std::string_view text) {
  const NoSigpipe no_sigpipe;
  for (std::string_view left = text; !left.empty();) {
    const ssize_t n = ::write(STDERR_FILENO, left.data(), left.size());
    if (n < 0 && errno != EINTR) break;
    left.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
  }
  for (std::size_t end; (end = text.find('\n')) != text.npos; text.remove_prefix(end + 1)) {
    error_line_ += text.substr(0, end);
    if (error_line_.find_first_not_of(" \t\r") != std::string::npos)
      last_error_line_ = std::exchange(error_line_, "");
    error_line_.clear();
  }
  error_line_ += text.substr(0, kErrorLineBytes - std::min(kErrorLineBytes, error_line_.size()));
}

std::string ChildProcess::last_error_line() const {
  return printable_line(error_line_.empty() ? last_error_line_ : error_line_);
}

bool ChildProcess::waits_for_input() const {
  int unread = 0;
  if (!out_.empty() || ::ioctl(child_.input.get(), FIONREAD, &unread) != 0 || unread > 0)
    return false;
  // The number of the system call and its arguments: read(0, ...).
  std::ifstream file("/proc/" + std::to_string(child_.pid) + "/syscall");
  long call = -1;
  std::string descriptor;
  return file >> call >> descriptor && call == SYS_read && descriptor == "0x0";
}

std::string ChildProcess::reap() {
  // The group first: its number cannot become another group's before its leader is waited for.
  ::kill(-child_.pid, SIGKILL);
  int status = 0;
  while (::waitpid(child_.pid, &status, 0) < 0 && errno == EINTR) {
  }
  child_.pid = -1;
  while (pass_errors_on()) {
  }
  has_given_up_ = WIFEXITED(status) && WEXITSTATUS(status) != 0;
  return hapgrid::how_it_ended(status);
}

void ChildProcess::end() {
  if (child_.pid < 0) return;
  hang_up();
  wait_until(Clock::now() + kGrace);
  reap();
}

void ChildProcess::kill() {
  if (child_.pid >= 0) reap();
}

std::string ChildProcess::how_it_ended() {
  if (child_.pid < 0) return "ended";
  hang_up();
  const bool by_itself = wait_until(Clock::now() + kEndingGrace);
  std::string how = reap();
  if (by_itself) return how;
  has_given_up_ = false;
  return "closed its standard output and stayed";
}

}  // namespace hapgrid
