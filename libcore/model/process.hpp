// A child process that reads and writes lines: starts it, feeds it, hears it, notices how it ended,
// and makes sure that it is gone.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/model/keeper.hpp"

namespace hapgrid {

/// What is run: no shell in between.
struct Command {
  std::vector<std::string> words;   ///< program and arguments; the program is looked up in PATH
  std::filesystem::path directory;  ///< where it runs, and where "./program" is looked for
};

/// The child has pipes as its standard streams; pump() passes on what comes by standard error.
/// Every other file of this process is closed in it, and it leads a process group of its own, so
/// that a Ctrl-C at the terminal is this program's alone. The keeper is its parent.
class ChildProcess {
 public:
  using Clock = std::chrono::steady_clock;

  /// @throw Error "cannot be started: ..." when the program is not found or cannot be executed.
  /// @param keeper outlives it
  ChildProcess(Keeper& keeper, const Command& command);
  /// As end().
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Text that pump() is to write.
  void send(std::string_view text) { out_ += text; }

  enum class Event { kMoved, kTimeout, kEnded };
  /// Writes and reads what it can without waiting; if it can do neither, waits until `deadline` at
  /// most.
  /// kEnded: the child has closed its output, or its input while there was something to write.
  /// What the child has written to standard error goes to that of this program.
  /// The calling thread must hold SIGPIPE back (NoSigpipe).
  Event pump(Clock::time_point deadline);
  /// The next whole line that came, without its end; valid until the next call of pump().
  bool next_line(std::string_view& line);
  /// What came behind the last whole line.
  std::string_view rest() const { return std::string_view(in_).substr(read_); }

  /// Closes its standard input: a process that reads to the end ends by itself.
  void hang_up();
  /// hang_up(), then after a grace of 2 s SIGTERM, after another 1 s SIGKILL.
  void end();
  /// Kills it at once, with all that it started.
  void kill();
  /// After kEnded: how the child ended. Kills a child that lives on.
  using End = KeptEnd;
  End how_it_ended();
  /// The last line that it wrote to standard error, in printable characters; empty without any.
  std::string last_error_line() const;

 private:
  bool wait_until(Clock::time_point deadline);
  bool pass_errors_on();
  void write_errors(std::string_view text);
  End reap();

  Keeper& keeper_;
  Kept kept_;  // pid -1: reaped
  FileDescriptor to_, from_, errors_;
  std::string out_;
  std::size_t written_ = 0;
  std::string in_;
  std::string buffer_;           // that read() fills
  std::size_t read_ = 0;         // lines before are taken
  std::size_t scanned_ = 0;      // no line ends in [read_, scanned_)
  std::string error_line_;       // of standard error, perhaps the beginning of one
  std::string last_error_line_;  // the last whole one with a word in it
};

}  // namespace hapgrid
