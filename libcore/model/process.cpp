#include "libcore/model/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <thread>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/signals.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t kReadBytes = 1 << 16;
constexpr std::size_t kErrorLineBytes = 4096;  // of a line of standard error that is remembered
constexpr auto kGrace = 2s;                    // after the end of its input
constexpr auto kTermGrace = 1s;                // after SIGTERM
constexpr auto kEndingGrace = 1s;              // between closing its output and being gone

[[noreturn]] void fail_by_errno(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// The file to execute. Looked up here and not between fork and exec, where hardly anything is
/// allowed.
fs::path find_program(const Command& command) {
  const std::string& program = command.words.at(0);
  if (program.find('/') != std::string::npos)
    return fs::current_path() / command.directory / program;
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
  throw Error("cannot be started: no program " + program + " in PATH");
}

struct Pipe {
  FileDescriptor read, write;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail_by_errno("a pipe to a model process");
    read = FileDescriptor(ends[0]);
    write = FileDescriptor(ends[1]);
  }
};

void set_nonblocking(int fd) {
  if (::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK) != 0) fail_by_errno("a pipe");
}

int milliseconds_until(ChildProcess::Clock::time_point deadline) {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - ChildProcess::Clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000));
}

}  // namespace

ChildProcess::ChildProcess(Keeper& keeper, const Command& command)
    : keeper_(keeper), buffer_(kReadBytes, '\0') {
  const fs::path file = find_program(command);
  Pipe in, out, errors;
  kept_ = keeper_.start({.file = file.string(),
                         .words = command.words,
                         .directory = command.directory.string(),
                         .in = in.read.get(),
                         .out = out.write.get(),
                         .errors = errors.write.get()});
  to_ = std::move(in.write);
  from_ = std::move(out.read);
  errors_ = std::move(errors.read);
  for (const FileDescriptor* end : {&to_, &from_, &errors_}) set_nonblocking(end->get());
}

ChildProcess::~ChildProcess() { end(); }

ChildProcess::Event ChildProcess::pump(Clock::time_point deadline) {
  // Taken lines are forgotten here, where no view of one is in use any more.
  if (read_ > 0) {
    in_.erase(0, read_);
    scanned_ -= read_;
    read_ = 0;
  }
  for (;;) {
    while (written_ < out_.size()) {
      const ssize_t n = ::write(to_.get(), out_.data() + written_, out_.size() - written_);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && errno != EAGAIN) return Event::kEnded;
      if (n < 0) break;
      written_ += static_cast<std::size_t>(n);
    }
    if (written_ == out_.size()) {
      out_.clear();
      written_ = 0;
    }
    pollfd fds[3] = {{from_.get(), POLLIN, 0}, {errors_.get(), POLLIN, 0}, {to_.get(), POLLOUT, 0}};
    const int ready = ::poll(fds, out_.empty() ? 2 : 3, milliseconds_until(deadline));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) fail_by_errno("a pipe from a model process");
    if (ready == 0) {
      if (Clock::now() < deadline) continue;
      return Event::kTimeout;
    }
    if (fds[1].revents != 0) pass_errors_on();
    if (fds[0].revents == 0) {
      if (Clock::now() >= deadline) return Event::kTimeout;  // however much it has to tell
      continue;
    }
    ssize_t n;
    do n = ::read(from_.get(), buffer_.data(), buffer_.size());
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

void ChildProcess::hang_up() { to_ = FileDescriptor(); }

bool ChildProcess::wait_until(Clock::time_point deadline) {
  // Most end at once when their input does.
  for (auto pause = 100us; !keeper_.has_ended(kept_); pause = std::min(2 * pause, 20'000us)) {
    if (Clock::now() >= deadline) return false;
    // A child that still writes must not wait for a reader.
    char ignored[4096];
    if (from_)
      while (::read(from_.get(), ignored, sizeof ignored) > 0) {
      }
    pass_errors_on();
    std::this_thread::sleep_for(pause);
  }
  return true;
}

/// Passes on a buffer of what has come by standard error. Answers whether there may be more.
bool ChildProcess::pass_errors_on() {
  if (!errors_) return false;
  char text[1 << 14];
  ssize_t n;
  do n = ::read(errors_.get(), text, sizeof text);
  while (n < 0 && errno == EINTR);
  if (n < 0 && errno == EAGAIN) return false;
  if (n <= 0) {
    errors_ = FileDescriptor();
    return false;
  }
  write_errors({text, static_cast<std::size_t>(n)});
  return true;
}

/// Writes it, whatever comes of that, and remembers its last line.
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

ChildProcess::End ChildProcess::reap() {
  End end = keeper_.end(kept_);
  kept_.pid = -1;
  while (pass_errors_on()) {
  }
  return end;
}

void ChildProcess::end() {
  if (kept_.pid < 0) return;
  hang_up();
  if (!wait_until(Clock::now() + kGrace)) {
    ::kill(-kept_.pid, SIGTERM);
    wait_until(Clock::now() + kTermGrace);
  }
  reap();
}

void ChildProcess::kill() {
  if (kept_.pid >= 0) reap();
  Keeper::kill_marked(kept_);
}

ChildProcess::End ChildProcess::how_it_ended() {
  if (kept_.pid < 0) return {"ended"};
  hang_up();
  const bool by_itself = wait_until(Clock::now() + kEndingGrace);
  const End end = reap();
  return by_itself ? end : End{"closed its standard output and stayed"};
}

}  // namespace hapgrid
