#include "libcore/model/launcher.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/family.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {

constexpr int kStandardStreams = 3;

[[noreturn]] void fail_by_errno() {
  throw std::system_error(errno, std::generic_category(), "a model process");
}

struct Pipe {
  FileDescriptor read, write;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail_by_errno();
    read = FileDescriptor(ends[0]);
    write = FileDescriptor(ends[1]);
    // Where this program was started without standard streams, the pipe has got their numbers, and
    // the child would overwrite it.
    for (FileDescriptor* end : {&read, &write})
      if (end->get() < kStandardStreams) {
        *end = FileDescriptor(::fcntl(end->get(), F_DUPFD_CLOEXEC, kStandardStreams));
        if (!*end) fail_by_errno();
      }
  }
};

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
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  Pipe input, output, errors, failed;
  const int streams[] = {input.read.get(), output.write.get(), errors.write.get()};
  const pid_t parent = ::getpid();
  // fork() would copy the tables of all memory, which play has locked: its loop would have to wait.
  const pid_t pid = ::vfork();
  if (pid < 0) fail_by_errno();
  if (pid == 0)
    become(file.c_str(), arguments.data(), directory.c_str(), streams, failed.write.get(), parent);
  failed.write = FileDescriptor();  // exec closes the child's
  int error = 0;
  ssize_t got;
  do got = ::read(failed.read.get(), &error, sizeof error);
  while (got < 0 && errno == EINTR);
  if (got <= 0)
    return {pid, std::move(input.write), std::move(output.read), std::move(errors.read)};
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
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, nullptr);
  for (;;) {
    std::unique_lock lock(mutex_);
    if (!has_task_.wait(lock, stop, [this] { return !tasks_.empty(); })) return;
    std::packaged_task<Child()> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task();
  }
}

}  // namespace hapgrid
