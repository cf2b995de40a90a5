// That a device is let go of when its program vanishes: a program of its own (guarded.cpp) is ended
// in every way, and what its device was told last is looked at.
#include "libcore/device/hid_guard.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include "libcore/base/error.hpp"
#include "tests/unit/device/standin_device.hpp"
#include "tests/unit/device/tiny_protocol.hpp"
#include "tests/unit/refusal.hpp"
#include "tests/unit/temporary.hpp"

using namespace hapgrid;
using Bytes = StandinDevice::Bytes;

namespace {

struct Program {
  pid_t pid = -1, guard = -1;
  FileDescriptor in, out;

  Program() {
    int to[2], from[2];
    REQUIRE(::pipe2(to, O_CLOEXEC) == 0);
    REQUIRE(::pipe2(from, O_CLOEXEC) == 0);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, to[0], 0);
    ::posix_spawn_file_actions_adddup2(&actions, from[1], 1);
    char name[] = HAPGRID_GUARDED;
    char* arguments[] = {name, nullptr};
    REQUIRE(::posix_spawn(&pid, name, &actions, nullptr, arguments, environ) == 0);
    ::posix_spawn_file_actions_destroy(&actions);
    in = FileDescriptor(to[1]);
    out = FileDescriptor(from[0]);
    ::close(to[0]);
    ::close(from[1]);
    std::string line;
    for (char c; ::read(out.get(), &c, 1) == 1 && c != '\n';) line += c;
    guard = static_cast<pid_t>(std::atoi(line.c_str()));
    REQUIRE(guard > 1);
  }
  ~Program() {
    if (pid > 0) end();
  }
  int end() {
    ::kill(pid, SIGKILL);
    return wait();
  }
  int wait() {
    int status = 0;
    ::waitpid(pid, &status, 0);
    pid = -1;
    return status;
  }
  /// The rest of its standard output: ends when nobody has the pipe any more, the guard neither.
  std::string rest() const {
    std::string text;
    for (char c; ::read(out.get(), &c, 1) == 1;) text += c;
    return text;
  }
};

struct Hardware : TemporaryDirectory, StandinDevice {
  Hardware() : StandinDevice(file("socket")) { input({0xA5, 20}, true); }
};

/// Whoever inherits it may take its time to bury it.
bool alive(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string number, name, state;
  return static_cast<bool>(file >> number >> name >> state) && state != "Z";
}

}  // namespace

TEST_CASE("the stop reports are the last thing written, however a program ends") {
  Hardware hardware;
  Program program;
  REQUIRE(hardware.wait_for_writes(3));
  const auto expect_stop = [&] {
    CHECK(hardware.wait([&] { return hardware.open() == 0; }));
    CHECK(hardware.written().back() == TinyProtocol::stopped());
  };
  CHECK(hardware.opened() == 3);

  SECTION("killed, after the signals that end everything in a session") {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT})
      REQUIRE(::kill(program.guard, signal) == 0);
    CHECK(::getsid(program.guard) == program.guard);
    CHECK(WTERMSIG(program.end()) == SIGKILL);
    expect_stop();
    CHECK(hardware.written_by_two());
    CHECK(program.rest().empty());
  }
  SECTION("aborted, crashed, or left without a word") {
    const char how = GENERATE('a', 's', 'e');
    REQUIRE(::write(program.in.get(), &how, 1) == 1);
    program.wait();
    expect_stop();
    CHECK(hardware.written_by_two());
  }
  SECTION("stopped, and let run again") {
    REQUIRE(::kill(program.pid, SIGSTOP) == 0);
    CHECK(hardware.wait([&] { return hardware.written_by_two(); }));
    CHECK(hardware.written().back() == TinyProtocol::stopped());
    const std::size_t before = hardware.written().size();
    REQUIRE(::kill(program.pid, SIGCONT) == 0);
    CHECK(WEXITSTATUS(program.wait()) == 3);  // the device failed
    expect_stop();
    // At most the force whose write was under way comes again.
    const std::vector<Bytes> written = hardware.written();
    CHECK(std::count(written.begin() + static_cast<std::ptrdiff_t>(before), written.end(),
                     TinyProtocol::force(7)) <= 1);
  }
  SECTION("in good order, which leaves the guard nothing to do") {
    REQUIRE(::write(program.in.get(), "q", 1) == 1);
    CHECK(program.wait() == 0);
    expect_stop();
    CHECK_FALSE(hardware.written_by_two());
    CHECK(program.rest() == "never flushed twice");
  }
  SECTION("the device was unplugged before") {
    hardware.vanish();
    CHECK(WEXITSTATUS(program.wait()) == 3);
  }
  const pid_t guard = program.guard;
  CHECK(hardware.wait([&] { return !alive(guard); }));
}

TEST_CASE("the guard has no file of the program's") {
  Hardware hardware;
  Program program;
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(program.guard) + "/fd")) {
    const std::string to = std::filesystem::read_symlink(entry.path()).string();
    CHECK((to == "/dev/null" || to.starts_with("socket:")));
    ++files;
  }
  CHECK(files == 3 + 1 + 2);  // standard streams, the parent, and the stand-in's device
}

TEST_CASE("a guard that is not released writes the stop reports, those that it was told last") {
  TemporaryDirectory directory;
  ::setenv("HAPGRID_STANDIN", directory.file("socket").c_str(), 1);
  auto guard = std::make_unique<HidGuard>();
  StandinDevice hardware(directory.file("socket"));
  const std::vector<Bytes> stop{TinyProtocol::force(0), Bytes(4097, 0xab), TinyProtocol::stopped()};
  guard->watch("tiny", {TinyProtocol::force(1)});
  guard->watch("tiny", stop);
  CHECK(hardware.opened() == 1);
  hardware.answer_writes(1, -1, "busy");  // then all of them once more
  guard.reset();
  std::vector<Bytes> written = hardware.written();
  REQUIRE(written.size() == 6);
  CHECK(written.back() == stop.back());
  written.resize(3);
  CHECK(written == stop);
}

TEST_CASE("a guard that cannot open the device says so") {
  TemporaryDirectory directory;
  HidGuard guard;
  StandinDevice hardware(directory.file("socket"));
  const auto refusal = [&guard] {
    return testing::refusal([&] { guard.watch("tiny", {TinyProtocol::stopped()}); });
  };
  // It was forked before the socket had a name.
  CHECK(refusal() == "the guard process: tiny: cannot be opened: no device process");
  guard.release();
  CHECK(hardware.wait([&] { return ::waitpid(guard.pid(), nullptr, WNOHANG) != 0; }));
  CHECK(refusal() == "tiny: the guard process does not answer");
}
