#include "tools/common/tool.hpp"

#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <system_error>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "tools/common/signals.hpp"

namespace hapgrid {

namespace {

/// A standard stream that was closed (`tool <&-`) would be taken by the first file that is opened,
/// and a message could end up in a shard. What is put in its place fails when it is used.
void occupy_standard_streams() {
  for (int fd = 0; fd <= 2; ++fd)
    if (::fcntl(fd, F_GETFD) < 0) ::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

/// A message is one line, whatever a file name or a library put into it.
int report(const std::string& tool, const std::string& message, int code) {
  say(tool, message);
  return code;
}

}  // namespace

void say(const std::string& tool, const std::string& text) {
  constexpr std::size_t kMost = 5000;  // bytes: the longest path fits, and no key of a megabyte
  std::fprintf(stderr, "%s: %s\n", tool.c_str(), printable_line(text, kMost).c_str());
}

void give_up_unread_messages() {
  constexpr int kPatience = 2000;  // ms
  pollfd reader{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&reader, 1, kPatience) != 0) return;
  const FileDescriptor nowhere(::open("/dev/null", O_WRONLY | O_CLOEXEC));
  if (nowhere) ::dup2(nowhere.get(), STDERR_FILENO);
}

void announce_terminal(const std::string& input) {
  struct stat status {};
  FileDescriptor
      named;  // /dev/stdin, /dev/tty; what is no device may be a pipe, which is not opened
  if (input != "-" && ::stat(input.c_str(), &status) == 0 && S_ISCHR(status.st_mode))
    named = FileDescriptor(::open(input.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (input == "-" ? ::isatty(STDIN_FILENO) : named && ::isatty(named.get()))
    say(program_invocation_short_name, "reads this terminal (Ctrl-D ends the input)");
}

void add_grid(CommandLine& app, std::string& name) {
  app.add("grid", name, "Grid to read ('-' or none: standard input)").type("GRID");
}

void add_output(CommandLine& app, std::string& name) {
  app.add("-o,--output", name,
          "File to write; it appears when it is complete ('-': standard output)")
      .type("FILE")
      .writes()
      .shows_default();
}

void add_cost(CommandLine& app, std::string& file) {
  app.add("--cost", file,
          "Append one JSON line to FILE: wall and CPU seconds (those of model processes when they "
          "have ended), conversions, host. Where the model ends the work, failed says why: "
          "levels or model")
      .type("FILE")
      .writes();
}

namespace {

int wrong_usage(const std::string& tool, const std::exception& e) {
  return report(tool, format("{} (see {} --help)", e.what(), tool), kExitUsage);
}

/// What `run` returns, or the exit code of what it throws.
int guarded(const std::string& tool, const std::function<int()>& run) {
  try {
    return run();
  } catch (const UsageError& e) {
    return wrong_usage(tool, e);
  } catch (const std::bad_alloc&) {
    return report(tool, "out of memory", kExitFailed);
  } catch (const std::system_error& e) {
    // Of a thread that cannot be started, std says the reason alone.
    const bool bare = e.what() == e.code().message();
    return report(tool, (bare ? "cannot start a thread: " : "") + std::string(e.what()),
                  kExitFailed);
  } catch (const std::exception& e) {
    return report(tool, e.what(), kExitFailed);
  } catch (...) {
    return report(tool, "unknown failure", kExitFailed);
  }
}

}  // namespace

void keep_memory() {
  constexpr int kBytes = 32 << 20;  // glibc takes no more as a threshold of mmap
  ::mallopt(M_MMAP_THRESHOLD, kBytes);
  ::mallopt(M_TRIM_THRESHOLD, kBytes);
  ::mallopt(M_TOP_PAD, 1 << 20);  // asked for at once, and not touched before it is used
}

int run_tool(CommandLine& app, int argc, char** argv, const std::function<int()>& run) {
  occupy_standard_streams();
  remove_unfinished_files_on_signals();
  const std::string tool = app.name();
  return guarded(tool, [&] {
    const std::optional<std::string> answer = app.parse(argc, argv);
    if (answer) std::cout << *answer;
    const int code = answer ? kExitDone : run();
    return std::cout.flush() ? code : report(tool, "cannot write to standard output", kExitFailed);
  });
}

}  // namespace hapgrid
