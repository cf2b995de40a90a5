#include "libcore/model/keeper.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/family.hpp"
#include "libcore/model/keeper_process.hpp"

namespace hapgrid {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

constexpr std::string_view kVariable = "HAPGRID_MODEL_OF=";
constexpr int kRounds = 200;  // a family that starts faster than it is killed is left in the end
constexpr auto kBetweenRounds = 2ms;

/// What a process was started with; empty when it is another user's, or a zombie.
std::string environment_of(pid_t pid) {
  const std::string name = "/proc/" + std::to_string(pid) + "/environ";
  const FileDescriptor file(::open(name.c_str(), O_RDONLY | O_CLOEXEC));
  std::string text;
  std::array<char, 1 << 14> buffer;
  for (ssize_t n; file && (n = ::read(file.get(), buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  return text;
}

std::optional<pid_t> pid_of(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename();
  pid_t pid = 0;
  const auto read = std::from_chars(name.data(), name.data() + name.size(), pid);
  if (read.ec != std::errc() || read.ptr != name.data() + name.size()) return std::nullopt;
  return pid;
}

/// @return whether there was one
bool kill_once(const std::string& mark) {
  bool any = false;
  std::error_code ignored;
  for (fs::directory_iterator entry("/proc", ignored), end; entry != end;
       entry.increment(ignored)) {
    const std::optional<pid_t> pid = pid_of(*entry);
    if (!pid || *pid == ::getpid()) continue;
    // Held before its environment is read: its number cannot become another process' meanwhile.
    const FileDescriptor process(static_cast<int>(::syscall(SYS_pidfd_open, *pid, 0)));
    if (!process || environment_of(*pid).find(mark) == std::string::npos) continue;
    any = ::syscall(SYS_pidfd_send_signal, process.get(), SIGKILL, nullptr, 0) == 0 || any;
  }
  return any;
}

void kill_all_with(const std::string& mark) {
  for (int round = 0; round < kRounds && kill_once(mark); ++round)
    std::this_thread::sleep_for(kBetweenRounds);
}

/// This program's environment with a mark, "NAME=VALUE" each. A model process that uses hapgrid
/// itself hands its own mark on with those of its models.
std::vector<std::string> environment_with(const std::string& mark) {
  std::vector<std::string> variables;
  std::string ours = std::string(kVariable) + mark;
  for (char** variable = ::environ; *variable; ++variable) {
    const std::string_view text(*variable);
    if (text.starts_with(kVariable))
      ours += text.substr(kVariable.size());
    else
      variables.emplace_back(text);
  }
  variables.push_back(std::move(ours));
  return variables;
}

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// What the keeper is told in a file, since an environment has no limit.
FileDescriptor file_of(const Launch& launch, const std::string& mark) {
  std::string text =
      launch.file + '\0' + launch.directory + '\0' + std::to_string(launch.words.size()) + '\0';
  for (const std::string& word : launch.words) text += word + '\0';
  for (const std::string& variable : environment_with(mark)) text += variable + '\0';
  FileDescriptor file(::memfd_create("launch", MFD_CLOEXEC));
  if (!file) fail("a model process");
  write_all(file.get(), std::as_bytes(std::span(text)), "a model process");
  return file;
}

/// @return whether it was sent
bool send(int socket, const KeeperRequest& request, std::span<const int> files) {
  iovec data{const_cast<KeeperRequest*>(&request), sizeof request};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(4 * sizeof(int))> control{};
  msghdr message{};
  message.msg_iov = &data;
  message.msg_iovlen = 1;
  if (!files.empty()) {
    message.msg_control = control.data();
    message.msg_controllen = CMSG_SPACE(files.size_bytes());
    cmsghdr* const c = CMSG_FIRSTHDR(&message);
    c->cmsg_level = SOL_SOCKET;
    c->cmsg_type = SCM_RIGHTS;
    c->cmsg_len = CMSG_LEN(files.size_bytes());
    std::memcpy(CMSG_DATA(c), files.data(), files.size_bytes());
  }
  return ::sendmsg(socket, &message, MSG_NOSIGNAL) >= 0;
}

}  // namespace

Keeper::Keeper()
    : mark_("/" + std::to_string(::getpid()) + "-" +
            std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()) + "/") {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    fail("the keeper's socket");
  socket_ = FileDescriptor(ends[0]);
  const FileDescriptor keepers(ends[1]);
  pid_ = ::fork();
  if (pid_ < 0) fail("the keeper process");
  if (pid_ == 0) become_keeper(keepers.get(), [this] { kill_all_with(mark_); });
}

Keeper::~Keeper() {
  socket_ = FileDescriptor();
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status)) kill_all_with(mark_);  // somebody has killed it
}

std::optional<KeeperAnswer> Keeper::ask(const KeeperRequest& request,
                                        std::span<const int> files) const {
  const std::lock_guard lock(mutex_);
  KeeperAnswer answer;
  ssize_t got = -1;
  if (send(socket_.get(), request, files)) {
    do got = ::recv(socket_.get(), &answer, sizeof answer, 0);
    while (got < 0 && errno == EINTR);
  }
  if (got != sizeof answer) return std::nullopt;
  return answer;
}

Kept Keeper::start(const Launch& launch) {
  Kept child;
  child.mark = mark_ + std::to_string(++children_) + "/";
  const FileDescriptor text = file_of(launch, child.mark);
  const int files[] = {text.get(), launch.in, launch.out, launch.errors};
  const auto answer = ask({}, files);
  if (!answer) throw Error("cannot be started: the process that keeps the models is gone");
  if (answer->error != 0)
    throw Error("cannot be started in " + (fs::current_path() / launch.directory).string() + ": " +
                std::generic_category().message(answer->error));
  child.pid = answer->pid;
  return child;
}

bool Keeper::has_ended(const Kept& child) const {
  const auto answer = ask({KeeperRequest::Kind::kLook, child.pid});
  return !answer || answer->ended;
}

KeptEnd Keeper::end(const Kept& child) {
  const auto answer = ask({KeeperRequest::Kind::kEnd, child.pid});
  if (!answer) return {"ended with the process that keeps the models"};
  return {how_it_ended(answer->status),
          WIFEXITED(answer->status) && WEXITSTATUS(answer->status) != 0};
}

void Keeper::kill_marked(const Kept& child) { kill_all_with(child.mark); }

}  // namespace hapgrid
