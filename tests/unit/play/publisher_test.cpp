// From a haptic loop to a viewer that is awake, slow, asleep or dead.
#include "tools/play/publisher.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/unit/catch.hpp"
#include "tests/unit/count_allocations.hpp"
#include "tests/unit/scene/scenes.hpp"
#include "tests/unit/temporary_directory.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;
using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;

std::atomic<int> stop{0};

/// Completes with what a frame says, so that a torn one shows.
void complete(Frame& frame) {
  frame.energy = frame.row[0] + frame.row[2];
  std::fill(frame.centres.begin(), frame.centres.end(), static_cast<float>(frame.tick % 1000));
}

void offer(FramePublisher& publisher, std::uint64_t tick) {
  Frame& s = publisher.next();
  const auto t = static_cast<double>(tick);
  s.tick = tick;
  s.time_s = t / 1000;
  s.hip = s.position = s.force = {t, t, t};
  s.row[0] = s.row[1] = s.row[2] = t;
  publisher.publish();
}

/// Offers a tick a millisecond for so long. @return the number of the next tick
std::uint64_t offer_for(FramePublisher& publisher, std::chrono::milliseconds time) {
  std::uint64_t tick = 0;
  for (const auto begin = Clock::now(); Clock::now() - begin < time; ++tick) {
    offer(publisher, tick);
    std::this_thread::sleep_for(1ms);
  }
  return tick;
}

std::vector<Frame> read_all(const std::string& file) {
  SceneReader reader(file);
  CHECK(reader.scene() == kScene);
  std::vector<Frame> frames;
  for (Frame frame; reader.next(frame);) {
    const auto t = static_cast<double>(frame.tick);
    CHECK(frame.hip == Vec3{t, t, t});
    CHECK(frame.force == Vec3{t, t, t});
    CHECK(frame.row == std::vector<double>{t, t});
    CHECK(frame.energy == 2 * t);
    CHECK(frame.centres[8] == static_cast<float>(frame.tick % 1000));
    frames.push_back(frame);
  }
  return frames;
}

/// A named pipe of two pages, whose reading end is open. (One with a single page is full as soon as
/// there is anything in it.)
constexpr int kPipeBytes = 8192;
constexpr std::uint64_t kPipeFrames = kPipeBytes / 300;  // more do not fit: a frame has 300 bytes
struct Pipe {
  TemporaryDirectory directory;
  std::string name = directory.file("pipe");
  FileDescriptor reader;

  Pipe() {
    REQUIRE(::mkfifo(name.c_str(), 0600) == 0);
    reader = FileDescriptor(::open(name.c_str(), O_RDONLY | O_NONBLOCK));
    REQUIRE(::fcntl(reader.get(), F_SETPIPE_SZ, kPipeBytes) == kPipeBytes);
  }
  OutputFile output() { return OutputFile(name, false); }
};

}  // namespace

TEST_CASE("a viewer that wakes up goes on with whole frames, to the last one") {
  Pipe pipe;
  std::atomic<std::uint64_t> last{0};
  FramePublisher publisher(pipe.output(), kScene, 3, complete, true, 1000, stop);
  std::thread viewer([&] {
    std::this_thread::sleep_for(800ms);
    ::fcntl(pipe.reader.get(), F_SETFL, 0);
    SceneReader reader(std::move(pipe.reader), "pipe");
    Frame frame;
    std::uint64_t frames = 0;
    for (; reader.next(frame); ++frames) CHECK(frame.energy == 2 * frame.row[1]);
    CHECK(frame.tick == last);
    CHECK(frames > 10);
  });
  last = offer_for(publisher, 1500ms) - 1;
  const FrameCounts counts = publisher.finish();
  viewer.join();
  CHECK_FALSE(counts.cut);
  CHECK(counts.dropped > 0);
}

TEST_CASE("without a pace the viewer is waited for until a signal asks to stop") {
  Pipe pipe;
  std::atomic<int> flag{0};
  FramePublisher publisher(pipe.output(), kScene, 3, complete, false, 1000, flag);
  std::thread signal([&] {
    std::this_thread::sleep_for(200ms);
    flag = SIGINT;
  });
  std::uint64_t tick = 0;
  for (; flag == 0; tick += 40) offer(publisher, tick);
  signal.join();
  CHECK(tick / 40 < kPipeFrames + 2);
  CHECK(publisher.finish().cut);
}

TEST_CASE("paced, publishing a tick allocates nothing, nor does the slow thread") {
  FramePublisher publisher(OutputFile("/dev/null", false), kScene, 3, complete, true, 1000, stop);
  std::this_thread::sleep_for(20ms);  // the thread has started
  offer(publisher, 0);
  std::this_thread::sleep_for(100ms);
  const std::uint64_t before = allocations();
  for (std::uint64_t tick = 1; tick < 300; ++tick) {
    offer(publisher, tick);
    std::this_thread::sleep_for(1ms);
  }
  CHECK(allocations() == before);
  CHECK(before > 0);
  CHECK(publisher.finish().written > 1);
}

TEST_CASE("paced, a viewer that sleeps costs frames, and one that died ends the writing") {
  for (const bool dies : {false, true}) {
    Pipe pipe;
    FramePublisher publisher(pipe.output(), kScene, 3, complete, true, 1000, stop);
    if (dies) pipe.reader = FileDescriptor();
    // The pipe is full, or closed, after half of this at the latest.
    offer_for(publisher, 2s);
    const auto end = Clock::now();
    const FrameCounts counts = publisher.finish();
    // A viewer that sleeps costs frames, and a second at the end.
    if (!dies) CHECK(counts.dropped > 0);
    if (!dies) CHECK(Clock::now() - end >= 1s);
    CHECK(counts.cut == !dies);
    CHECK(counts.closed == dies);
    CHECK(counts.written < kPipeFrames);
  }
}

TEST_CASE("a model that never answers does not hold up the end") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("f");
  auto* const publisher = new FramePublisher(  // and stays, with the thread that is left behind
      OutputFile(name, false), kScene, 3,
      [asked = 0](Frame& frame) mutable {
        complete(frame);
        if (asked++ > 0) std::this_thread::sleep_for(1000h);
      },
      true, 1000, stop);
  offer_for(*publisher, 300ms);
  const FrameCounts counts = publisher->finish();
  CHECK(counts.lacking);
  CHECK_FALSE(counts.cut);
  CHECK(counts.written > 0);
  CHECK(read_all(name).size() == counts.written);
}

TEST_CASE("a triple buffer gives the newest value, once") {
  TripleBuffer<int> buffer(7);
  CHECK_FALSE(buffer.update());
  CHECK(buffer.front() == 7);
  for (const int i : {1, 2, 3}) {
    buffer.back() = i;
    buffer.publish();
  }
  CHECK(buffer.update());
  CHECK(buffer.front() == 3);
  CHECK_FALSE(buffer.update());
  CHECK(buffer.front() == 3);
  buffer.back() = 4;
  CHECK_FALSE(buffer.update());

  // Two threads: values ascend and are whole.
  TripleBuffer<std::pair<std::uint64_t, std::uint64_t>> pairs({0, 0});
  constexpr std::uint64_t kLast = 200000;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      pairs.back() = {i, i};
      pairs.publish();
    }
  });
  bool whole = true, ascending = true;
  for (std::uint64_t last = 0; last < kLast;) {
    if (!pairs.update()) continue;
    whole = whole && pairs.front().first == pairs.front().second;
    ascending = ascending && pairs.front().first > last;
    last = pairs.front().first;
  }
  writer.join();
  CHECK(whole);
  CHECK(ascending);
}
