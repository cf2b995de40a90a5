// From a haptic loop to a file: in order, without waiting, and nothing lost without being counted.
#include "libcore/session/recorder.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/session/ticks.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;
using namespace std::chrono_literals;

namespace {

/// A pipe that nobody reads from yet, as a disk that does not answer.
struct StuckDisk {
  TemporaryDirectory directory;
  std::string name = directory.file("pipe");
  FileDescriptor reader;
  StuckDisk() {
    REQUIRE(::mkfifo(name.c_str(), 0600) == 0);
    reader = FileDescriptor(::open(name.c_str(), O_RDONLY | O_NONBLOCK));
    REQUIRE(reader);
    ::fcntl(reader.get(), F_SETFL, 0);
  }
  /// Until a writer has filled the pipe, of 64 kB, and wants to write more.
  void wait_until_stuck() const {
    const auto deadline = std::chrono::steady_clock::now() + 60s;
    for (int bytes = 0; bytes < (60 << 10);) {
      REQUIRE(::ioctl(reader.get(), FIONREAD, &bytes) == 0);
      REQUIRE(std::chrono::steady_clock::now() < deadline);
      std::this_thread::sleep_for(1ms);
    }
  }
  /// All that comes, into a regular file.
  std::jthread answer(const std::string& file) {
    return std::jthread([this, file] {
      const FileDescriptor to(::open(file.c_str(), O_CREAT | O_WRONLY, 0600));
      std::array<char, 1 << 16> buffer;
      for (ssize_t count; (count = ::read(reader.get(), buffer.data(), buffer.size())) > 0;)
        if (::write(to.get(), buffer.data(), static_cast<std::size_t>(count)) != count) return;
    });
  }
};

}  // namespace

TEST_CASE("two threads and a ring: nothing is lost, doubled or torn") {
  struct Wide {
    std::uint64_t a, b, c;
  };
  constexpr std::uint64_t kValues = 1'000'000;
  for (const std::size_t capacity : {1, 7, 4096}) {
    SpscRing<Wide> ring(capacity);
    // Each time that a small ring is full or empty, the threads change places, which takes
    // milliseconds where other programs run as well.
    const std::uint64_t values = capacity < 10 ? kValues / 1000 : kValues;
    std::uint64_t refused = 0;
    std::jthread writer([&] {
      for (std::uint64_t i = 0; i < values;)
        if (ring.push({i, ~i, i * 3})) {
          ++i;
        } else {
          ++refused;
          std::this_thread::yield();
        }
    });
    std::uint64_t next = 0;
    std::uint64_t wrong = 0;
    while (next < values) {
      const std::span<const Wide> got = ring.peek();
      for (const Wide& w : got) {
        if (w.a != next || w.b != ~next || w.c != next * 3) ++wrong;
        ++next;
      }
      ring.pop(got.size());
      if (got.empty()) std::this_thread::yield();
    }
    writer.join();
    CHECK(wrong == 0);
    CHECK(next == values);
    CHECK(ring.peek().empty());
  }
}

TEST_CASE("a paced recording has every tick") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  SessionHeader header = small_header();
  header.rate_hz = 10000;
  const std::vector<TickRecord> ticks = random_ticks(50'000, 1);  // less than 8 s
  SessionRecorder recorder(file, header, true);
  bool kept = true;
  for (const TickRecord& tick : ticks) kept = recorder.add(tick) && kept;
  CHECK(kept);
  CHECK(recorder.finish() == ticks.size());
  CHECK(recorder.dropped() == 0);
  SessionReader reader(file);
  CHECK(same(rest_of(reader), ticks));
  CHECK(reader.dropped() == 0);
}

TEST_CASE("a disk that does not answer costs ticks, never time nor memory") {
  StuckDisk disk;
  SessionHeader header = small_header();
  header.rate_hz = 1000;  // 8000 ticks in the ring
  const std::vector<TickRecord> ticks = random_ticks(40'000, 2);
  const std::string copy = disk.directory.file("copy");
  std::vector<TickRecord> kept;
  {
    SessionRecorder recorder(disk.name, header, true);
    kept.reserve(ticks.size());
    const auto add = [&](std::size_t i) {
      if (recorder.add(ticks[i])) kept.push_back(ticks[i]);
    };
    constexpr std::size_t kWritten =
        kChunkTicks + 1;  // a chunk, and what makes the writer begin it
    for (std::size_t i = 0; i < kWritten; ++i) add(i);
    disk.wait_until_stuck();
    // The slow thread waits for the pipe: what is allocated now would be add()'s.
    const std::uint64_t before = allocations();
    for (std::size_t i = kWritten; i < ticks.size(); ++i) add(i);
    CHECK(allocations() == before);
    CHECK(recorder.dropped() == ticks.size() - kept.size());
    CHECK(kept.size() >= 8000);
    CHECK(kept.size() <= 8000 + kWritten);
    const std::jthread reading = disk.answer(copy);
    CHECK(recorder.finish() == kept.size());
  }
  SessionReader reader(copy);
  CHECK(same(rest_of(reader), kept));
  CHECK(reader.dropped() == ticks.size() - kept.size());
}

TEST_CASE("a write that fails is told at the end") {
  // The end of a pipe that is closed. SIGPIPE would end the test.
  const auto handler = ::signal(SIGPIPE, SIG_IGN);
  for (const bool paced : {false, true}) {
    StuckDisk disk;
    SessionRecorder recorder(disk.name, small_header(), paced);
    disk.reader = FileDescriptor();
    const std::vector<TickRecord> ticks = random_ticks(5000, 4);
    for (const TickRecord& tick : ticks) recorder.add(tick);  // goes on
    CHECK_THROWS_WITH(recorder.finish(),
                      Catch::Matchers::ContainsSubstring(disk.name + ": Broken pipe"));
  }
  ::signal(SIGPIPE, handler);
}

TEST_CASE("a recording that fails keeps what was recorded before") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("x.session");
  for (const bool paced : {false, true}) {
    std::vector<TickRecord> ticks = random_ticks(5000, 5);
    ticks.back().number = 0;  // the one thing that can be wrong with a tick
    {
      SessionRecorder recorder(file, small_header(), paced);
      for (const TickRecord& tick : ticks) recorder.add(tick);
      CHECK_THROWS_WITH(recorder.finish(),
                        Catch::Matchers::StartsWith(file + ": tick 0 after tick "));
    }
    ticks.resize(kChunkTicks);
    SessionReader reader(file);
    CHECK(same(rest_of(reader), ticks));
  }
}
