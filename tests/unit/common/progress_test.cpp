// How often progress is told, and how wide. The time is virtual: nobody waits.
#include "tools/common/progress.hpp"

#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

#include "tests/unit/catch.hpp"

using namespace hapgrid;
using std::chrono::milliseconds;

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// How long each pause was, when the work is done in the fourth one.
std::vector<milliseconds> told(std::FILE* out, const std::string& text) {
  std::vector<milliseconds> pauses;
  write_progress(
      out, [&] { return text; },
      [&](milliseconds pause) {
        pauses.push_back(pause);
        return pauses.size() == 4;
      });
  std::fflush(out);
  return pauses;
}

}  // namespace

TEST_CASE("a log gets a whole line once a minute, and nothing else") {
  const File log(std::tmpfile(), std::fclose);
  REQUIRE(log);
  const std::string line(300, 'x');
  CHECK(told(log.get(), line) == std::vector<milliseconds>(4, std::chrono::minutes{1}));
  std::rewind(log.get());
  std::string text(1000, ' ');
  text.resize(std::fread(text.data(), 1, text.size(), log.get()));
  CHECK(text == line + "\n" + line + "\n" + line + "\n");
}

TEST_CASE("a terminal gets one line several times a second, which is never wrapped") {
  for (const unsigned short columns : {60, 100}) {
    winsize size{10, columns, 0, 0};
    int ends[2];
    REQUIRE(::openpty(&ends[0], &ends[1], nullptr, nullptr, &size) == 0);
    const File seen(::fdopen(ends[0], "r"), std::fclose);
    const File terminal(::fdopen(ends[1], "w"), std::fclose);
    CHECK(told(terminal.get(), std::string(300, 'x')) ==
          std::vector<milliseconds>(4, milliseconds{250}));
    const std::string shown = "\r\033[K" + std::string(columns - 1u, 'x');
    const std::string all = shown + shown + shown + "\r\033[K";
    std::string text(all.size(), ' ');
    REQUIRE(std::fread(text.data(), 1, text.size(), seen.get()) == text.size());
    CHECK(text == all);
    int more = 1;
    CHECK(::ioctl(ends[0], FIONREAD, &more) == 0);
    CHECK(more == 0);
  }
}
