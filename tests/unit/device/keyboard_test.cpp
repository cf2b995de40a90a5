// What a terminal sends for keys (ECMA-48, as xterm's documentation lists them); any bytes are in
// tests/fuzz/streams.cpp, and a pseudo terminal in tests/cli/play/keys.sh.
#include "libcore/device/keyboard.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <exception>

#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"

using namespace hapgrid;

namespace {

const Box kBox{{-1, -1, -1}, 1, {3, 3, 3}};
const Vec3 kStart{0, 0, 0};
constexpr double kStep = 0.25;

Vec3 after(std::string_view bytes) {
  KeyReader reader(kBox, kStart, kStep);
  for (const char c : bytes) reader.read(static_cast<unsigned char>(c));
  return reader.target();
}

}  // namespace

TEST_CASE("arrows and page keys, in both of a terminal's modes and with modifiers") {
  const std::pair<const char*, Vec3> keys[] = {{"\x1b[C", {0.25, 0, 0}},
                                               {"\x1b[D", {-0.25, 0, 0}},
                                               {"\x1bOA", {0, 0, 0.25}},
                                               {"\x1bOB", {0, 0, -0.25}},
                                               {"\x1b[5~", {0, 0.25, 0}},
                                               {"\x1b[6~", {0, -0.25, 0}},
                                               {"\x1b[1;5C", {0.25, 0, 0}},
                                               {"\x1b[;5~", {0, 0, 0}},
                                               {"\x1b[5;2~", {0, 0.25, 0}},
                                               {"\x1b[5;2;3;4;5;6;7~", {0, 0.25, 0}},
                                               {"\x1b[C\x1b[C\x1b[B", {0.5, 0, -0.25}}};
  for (const auto& [bytes, to] : keys) CHECK(after(bytes) == to);
}

TEST_CASE("other keys") {
  CHECK(after("\x1b[C+\x1b[C")[0] == Approx(0.25 + 0.375));
  CHECK(after("-\x1b[C")[0] == Approx(0.25 / 1.5));
  CHECK(after("\x1b[C\x1b[A0") == Vec3{0, 0, 0});
  CHECK(after("\x1b[H\x1b[3~xyz\x1bx") == Vec3{0, 0, 0});
  CHECK(after("\x1b[C\x1b[C\x1b[C\x1b[C\x1b[C\x1b[C")[0] == 1);  // not out of the box
  KeyReader reader(kBox, kStart, kStep);
  reader.read('r');
  CHECK(reader.resets() == 1);
  reader.read('n');
  CHECK(reader.nexts() == 1);
  CHECK_FALSE(reader.quit());
  reader.read('q');
  CHECK(reader.quit());
}

namespace {

/// Of a process with a terminal of its own: the HIP follows a key while read() and send() allocate
/// nothing.
bool follows_without_allocating() {
  ::setsid();
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) return false;
  if (::open(::ptsname(terminal), O_RDWR) < 0) return false;  // now the session's own
  KeyboardDevice keys(kBox, kStart, kStep);
  if (::write(terminal, "\x1b[C", 3) != 3) return false;
  DeviceInput input;
  const auto begin = std::chrono::steady_clock::now();
  const std::uint64_t before = testing::allocations_of_thread();
  bool ok = true;
  for (int i = 0; i < 1000 || input.position[0] < 0.2; ++i) {
    ok = keys.read(input) == DeviceStatus::kOk && keys.send({1, 0, 0}) == DeviceStatus::kOk && ok;
    if (std::chrono::steady_clock::now() - begin > std::chrono::seconds(20)) return false;
  }
  return ok && testing::allocations_of_thread() == before;
}

}  // namespace

TEST_CASE("the keyboard's read() and send() do not allocate") {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    bool good = false;
    try {
      good = follows_without_allocating();
    } catch (const std::exception&) {
    }
    ::_exit(good ? 0 : 1);
  }
  int status = -1;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
}
