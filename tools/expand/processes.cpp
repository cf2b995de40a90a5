#include "tools/expand/processes.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <thread>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/shard/section.hpp"
#include "tools/common/signals.hpp"

extern char** environ;

namespace hapgrid {

namespace fs = std::filesystem;

namespace {

using Words = std::vector<std::string>;

/// A folder that is removed at the end, beside a file or among the temporary files.
class Folder {
 public:
  explicit Folder(const std::string& output) {
    std::error_code ignored;
    const bool beside = output != "-" && !fs::is_other(output, ignored);
    const fs::path where = beside ? fs::path(output).parent_path() : fs::temp_directory_path();
    std::string name = (where / ".hapgrid-rounds.XXXXXX").string();
    if (!::mkdtemp(name.data()))
      throw std::system_error(errno, std::generic_category(), "a temporary folder for the rounds");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

void append_file(const std::string& name, OutputFile& out) {
  const InputFile in(name);
  std::vector<std::byte> bytes(1 << 20);
  for (std::uint64_t at = 0; at < in.size();) {
    const std::size_t got = in.read(at, bytes);
    if (got == 0) throw Error(format("{}: ends early", name));
    out.write(std::span(bytes).first(got));
    at += got;
  }
}

/// Starts a program, whose standard error goes to the file `errors`.
pid_t start(const Words& words, const std::string& errors) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t pid = -1;
  const int error =
      ::posix_spawn(&pid, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::system_error(error, std::generic_category(), words[0]);
  return pid;
}

/// Runs programs side by side. @returns the exit code of the first in their order that failed, or
/// 128 + a signal
int run_all(const std::vector<Words>& commands, const Folder& folder) {
  std::vector<pid_t> running;
  std::vector<std::string> errors;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    errors.push_back(folder.file(format("{}.errors", k)));
    running.push_back(start(commands[k], errors.back()));
  }
  std::vector<int> codes(commands.size(), 0);
  bool is_told = false;
  for (std::size_t left = commands.size(); left > 0;) {
    for (std::size_t k = 0; k < running.size(); ++k) {
      int status = 0;
      if (running[k] < 0 || ::waitpid(running[k], &status, WNOHANG) == 0) continue;
      running[k] = -1;
      --left;
      codes[k] = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    if (caught_signal != 0 && !is_told) {
      is_told = true;
      for (const pid_t pid : running)
        if (pid > 0) ::kill(pid, SIGTERM);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (caught_signal != 0) return 128 + caught_signal;
  int failed = 0;
  for (std::size_t k = 0; k < codes.size() && failed == 0; ++k) {
    failed = codes[k];
    const std::string said = read_text(errors[k], 1 << 24);
    static_cast<void>(std::fputs(said.c_str(), stderr));
  }
  return failed;
}

}  // namespace

int expand_in_processes(const ProcessRounds& rounds) {
  for (const char* threads : {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"})
    ::setenv(threads, "1", /*overwrite=*/0);
  const CaughtSignals signals(CaughtSignals::kEnding);
  OutputFile out(rounds.output);
  const Folder folder(rounds.output);
  const fs::path self = fs::read_symlink("/proc/self/exe");
  std::string grid = rounds.grid;
  if (grid == "-") {
    grid = folder.file("0.grid");
    OutputFile copy(grid);
    copy.write(read_text("-", std::uint64_t{1} << 40));
    copy.commit();
  }
  for (int round = 1; open_grid(grid).next_round(); ++round) {
    std::vector<Words> parts;
    Words merge{(self.parent_path() / "merge").string(), grid};
    for (unsigned k = 1; k <= rounds.processes; ++k) {
      const std::string requests = folder.file(format("{}.requests.{}", round, k));
      merge.push_back(requests);
      Words words{self.string(), grid,    "--part", format("{}/{}", k, rounds.processes),
                  "-o",          requests};
      words.insert(words.end(), rounds.of_both.begin(), rounds.of_both.end());
      words.insert(words.end(), rounds.of_expand.begin(), rounds.of_expand.end());
      parts.push_back(std::move(words));
    }
    if (const int code = run_all(parts, folder)) return code;
    if (!rounds.complete) {
      for (unsigned k = 0; k < rounds.processes; ++k) append_file(merge[k + 2], out);
      out.commit();
      return 0;
    }
    const std::string next = folder.file(format("{}.grid", round));
    merge.insert(merge.end(), {"-o", next});
    merge.insert(merge.end(), rounds.of_both.begin(), rounds.of_both.end());
    if (const int code = run_all({merge}, folder)) return code;
    for (unsigned k = 0; k < rounds.processes; ++k) fs::remove(merge[k + 2]);
    if (round > 1 || rounds.grid == "-") fs::remove(grid);
    grid = next;
  }
  append_file(grid, out);
  out.commit();
  return 0;
}

}  // namespace hapgrid
