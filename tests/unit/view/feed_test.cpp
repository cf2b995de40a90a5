// The thread that reads: it keeps up with every writer, and ends when it is told to.
#include "tools/view/feed.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "libcore/base/error.hpp"
#include "tests/unit/catch.hpp"
#include "tests/unit/scene/scenes.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;
using testing::small_frame;
using testing::small_scene;

namespace {

/// A pipe with a name, open for writing.
struct Pipe {
  std::filesystem::path name;
  FileDescriptor file;
  SceneEncoder encoder;

  explicit Pipe(std::filesystem::path where) : name(std::move(where)) {
    REQUIRE(::mkfifo(name.c_str(), 0600) == 0);
    file = FileDescriptor(::open(name.c_str(), O_RDWR | O_CLOEXEC));  // waits for no reader
    REQUIRE(file);
  }
  void write(std::span<const std::byte> bytes) {
    REQUIRE(::write(file.get(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  void write(const Frame& frame) { write(encoder.encode(frame, 2)); }
};

/// Waits for what the feed reports, with a limit that is only reached when it never comes.
struct Bell {
  std::atomic<int> rung{0};
  void ring() { ++rung; }
  void wait_for(int rings) const {
    using Clock = std::chrono::steady_clock;
    for (const auto begin = Clock::now(); rung < rings;) {
      REQUIRE(Clock::now() - begin < std::chrono::seconds(60));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
};

}  // namespace

TEST_CASE("a writer is never behind a reader that draws nothing, who gets the newest frame") {
  const TemporaryDirectory directory;
  Pipe pipe(directory.path() / "pipe");
  pipe.write(pipe.encoder.encode(small_scene()));
  Bell bell;
  Feed feed(pipe.name, [&] { bell.ring(); });
  CHECK(feed.scene() == small_scene());
  CHECK_FALSE(feed.recorded());
  feed.start();
  // Far more than fits into a pipe: this ends only if somebody reads.
  constexpr int kFrames = 2000;
  for (int i = 0; i < kFrames; ++i) pipe.write(small_frame(i));
  bell.wait_for(kFrames);
  Frame frame;
  Feed::State state = feed.update(frame);
  CHECK(state.fresh);
  CHECK_FALSE(state.ended);
  CHECK(frame.tick == kFrames - 1);
  state = feed.update(frame);
  CHECK_FALSE(state.fresh);
  // A few frames wait for a drawing that is late; of more there is the newest.
  for (const int waiting : {3, 4}) {
    for (int i = 0; i < waiting; ++i) pipe.write(small_frame(5000 + 10 * waiting + i));
    bell.wait_for(kFrames + (waiting == 3 ? 3 : 7));
    for (int i = waiting == 3 ? 0 : 3; i < waiting; ++i) {
      state = feed.update(frame);
      CHECK(frame.tick == 5000u + 10 * waiting + i);
      CHECK(state.more == (i + 1 < waiting));
    }
  }
  // Its thread waits for more, which never comes: the test ends all the same.
}

TEST_CASE("the end of a stream is told, and what ended it") {
  const TemporaryDirectory directory;
  SceneEncoder encoder;
  const auto name = directory.path() / "frames";
  const auto play = [&](std::size_t left_out) {
    std::vector<std::byte> bytes;
    testing::append(bytes, encoder.encode(small_scene()));
    for (const int tick : {0, 1, 2}) testing::append(bytes, encoder.encode(small_frame(tick), 2));
    std::ofstream(name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size() - left_out));
  };
  Frame frame;
  {
    play(0);
    Bell bell;
    Feed feed(name, [&] { bell.ring(); });
    feed.start();
    bell.wait_for(4);
    for (const std::uint64_t tick : {0, 1, 2}) {
      const Feed::State state = feed.update(frame);
      CHECK(state.fresh);
      CHECK(state.ended == (tick == 2));
      CHECK(frame.tick == tick);
    }
    feed.check();
  }
  play(1);
  Bell bell;
  Feed feed(name, [&] { bell.ring(); });
  feed.start();
  bell.wait_for(3);
  CHECK_FALSE(feed.update(frame).ended);
  CHECK(feed.update(frame).ended);
  CHECK(frame.tick == 1);
  CHECK_THROWS_AS(feed.check(), FormatError);
}

TEST_CASE("a file is played in its own time") {
  const TemporaryDirectory directory;
  const auto name = directory.path() / "frames";
  std::vector<std::byte> bytes;
  SceneEncoder encoder;
  testing::append(bytes, encoder.encode(small_scene()));
  // 0.2 s apart, then a thousand years.
  for (const double time_s : {7.0, 7.2, 3e10}) {
    Frame frame = small_frame(static_cast<std::uint64_t>(time_s * 1000));
    frame.time_s = time_s;
    testing::append(bytes, encoder.encode(frame, 2));
  }
  std::ofstream(name, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto since = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  Bell bell;
  Feed feed(name, [&] { bell.ring(); });
  CHECK(feed.recorded());
  feed.start();
  bell.wait_for(1);
  Frame frame;
  CHECK(feed.update(frame).fresh);
  bell.wait_for(2);
  CHECK(since() >= 0.2);
  feed.update(frame);
  CHECK(frame.time_s == 7.2);
  CHECK_FALSE(feed.update(frame).ended);
  // The third one is not waited for.
}
