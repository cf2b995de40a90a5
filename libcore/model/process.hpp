// A child process that reads and writes lines.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "libcore/base/file.hpp"

namespace hapgrid {

// Starts child processes, each in a process group of its own.
//
// The kernel kills a child when this program ends, however it ends (PR_SET_PDEATHSIG). To the
// kernel the parent of a child is the thread that started it, not the program. So a launcher has a
// thread that starts all its children and lives longer than they do.

/// A child process, and this program's ends of the pipes that are its standard streams.
struct Child {
  pid_t pid = -1;  ///< also the number of its process group
  FileDescriptor input, output, errors;
};

class Launcher {
 public:
  Launcher();
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// May be called by any thread. The child has only its standard streams open.
  /// @param file the program's path
  /// @param words the arguments, which begin with the program's name
  /// @param directory where the child runs; empty: where this program runs
  /// @throw Error "cannot be started in DIRECTORY: ..."; std::system_error
  Child start(const std::string& file, const std::vector<std::string>& words,
              const std::string& directory);

 private:
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any has_task_;
  std::deque<std::packaged_task<Child()>> tasks_;
  std::jthread thread_;  // declared last: it uses the others
};

/// The child has pipes as its standard streams, and no other file of this process. It leads a
/// process group of its own, so that a Ctrl-C at the terminal reaches only this program. When the
/// ChildProcess is destroyed, the whole group is killed. A process that the child started and that
/// has left the group may live on.
class ChildProcess {
 public:
  using Clock = std::chrono::steady_clock;

  /// @throw Error "cannot be started: ..." when the program is not found or cannot be executed.
  /// @param launcher outlives the child
  /// @param command program and arguments, without a shell; the program is looked up in PATH
  /// @param directory where it runs, and where "./program" is looked for
  ChildProcess(Launcher& launcher, const std::vector<std::string>& command,
               const std::filesystem::path& directory);
  /// As end().
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Appends to the text that pump() writes.
  void send(std::string_view text) { out_ += text; }

  enum class Event { kMoved, kTimeout, kEnded };
  /// Writes to the child and reads from it without waiting. If neither is possible, it waits, at
  /// most until `deadline`. The child's standard error is copied to that of this program.
  /// kEnded: the child has closed its output, or its input while there was something to write.
  /// The calling thread must block SIGPIPE (NoSigpipe).
  Event pump(Clock::time_point deadline);
  /// The next whole line that was read, without its end. It is valid until the next call of pump().
  /// Returns false when there is none.
  bool next_line(std::string_view& line);
  /// The beginning of a line whose end has not been read yet.
  std::string_view rest() const { return std::string_view(in_).substr(read_); }

  /// Closes its standard input: a process that reads to the end ends by itself.
  void hang_up();
  /// hang_up(); the child has 2 s to end. Then its group is killed.
  void end();
  /// Kills the group of the child at once.
  void kill();
  /// How the child ended, after kEnded: "exited with status 3". A child that is still there after
  /// 1 s is killed.
  std::string how_it_ended();
  /// After that: it exited by itself, and not with status 0.
  bool has_given_up() const { return has_given_up_; }
  /// The last line that it wrote to standard error, in printable characters; empty without any.
  std::string last_error_line() const;
  /// The path of its program.
  const std::string& program() const { return program_; }
  /// Whether it has read all of its input and waits for more: the kernel says so of its first
  /// thread, as long as this program may look at it.
  bool waits_for_input() const;
  /// Of the child and of all that it has started; 0 when it has ended.
  std::uint64_t memory_bytes() const;

 private:
  bool has_ended() const;
  bool wait_until(Clock::time_point deadline);
  bool pass_errors_on();
  void write_errors(std::string_view text);
  std::string reap();

  std::string program_;
  Child child_;  // pid -1: its end has been waited for
  std::string out_;
  std::size_t written_ = 0;
  std::string in_;
  std::string buffer_;           // read() writes here
  std::size_t read_ = 0;         // next_line() has returned the lines before
  std::size_t scanned_ = 0;      // no line ends in [read_, scanned_)
  std::string error_line_;       // the current line of standard error, so far
  std::string last_error_line_;  // the last whole line of it that is not blank
  bool has_given_up_ = false;
};

}  // namespace hapgrid
