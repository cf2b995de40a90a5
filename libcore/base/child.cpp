#include "libcore/base/child.hpp"

#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "libcore/base/format.hpp"

namespace hapgrid {

void begin_child(pid_t parent) noexcept {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::kill(::getpid(), SIGKILL);  // it died before prctl()
}

std::string how_it_ended(int status) {
  if (!WIFSIGNALED(status)) return format("exited with status {}", WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  const char* name = ::sigdescr_np(signal);
  return format("was killed by signal {}", signal) + (name ? format(" ({})", name) : "");
}

std::vector<char*> argument_list(std::vector<std::string>& words) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  return arguments;
}

void restore_signals() noexcept {
  for (int signal = 1; signal < NSIG; ++signal) ::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

int milliseconds_until(std::chrono::steady_clock::time_point deadline) noexcept {
  const auto left =
      std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000));
}

namespace {

std::uint64_t page() { return static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)); }

/// Resident bytes of the process whose file `stat` is given, if it belongs to the group.
std::uint64_t member_bytes(const std::filesystem::path& stat, pid_t group) {
  constexpr int kGroupField = 2, kResidentField = 21;  // behind the name: proc(5)
  std::ifstream file(stat);
  std::string text;
  std::getline(file, text);
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return 0;
  std::istringstream fields(text.substr(name_end + 1));
  std::string field;
  for (int k = 0; fields >> field; ++k) {
    if (k == kGroupField && field != std::to_string(group)) return 0;
    if (k == kResidentField) return std::stoull(field) * page();
  }
  return 0;
}

}  // namespace

std::uint64_t memory_of_this_process() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * page();
}

std::uint64_t memory_of_group(pid_t group) {
  std::uint64_t sum = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos)
      sum += member_bytes(entry.path() / "stat", group);
  }
  return sum;
}

}  // namespace hapgrid
