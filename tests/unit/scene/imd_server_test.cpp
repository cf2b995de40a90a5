// The server of IMD and clients of all kinds. Their sockets are plain ones; the bytes of frames are
// the encoder's, which has its own tests.
#include "libcore/scene/imd_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <vector>

#include "tests/unit/scene/scenes.hpp"

using namespace hapgrid;
using namespace hapgrid::testing;
using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::byte>;

constexpr auto kLong = 20s;  // for what must happen, however slow the machine is
const std::atomic<int> kNever{0};

Bytes header(unsigned type, unsigned length) {
  Bytes bytes;
  for (const unsigned value : {type, length})
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes.push_back(static_cast<std::byte>(value >> shift));
  return bytes;
}

class Viewer {
 public:
  /// @param receive_buffer bytes; 0: the system's.
  explicit Viewer(const ImdServer& server, int receive_buffer = 0)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const std::string& name = server.name();
    to.sin_port = htons(static_cast<std::uint16_t>(std::stoi(name.substr(name.find(':') + 1))));
    if (receive_buffer > 0)
      ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    REQUIRE(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&to), sizeof to) == 0);
  }

  bool say(const Bytes& bytes) {
    return ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }
  /// `size` bytes; fewer where the server closes or nothing comes.
  Bytes take(std::size_t size, std::chrono::milliseconds patience = kLong) {
    Bytes bytes(size);
    std::size_t done = 0;
    while (done < size) {
      if (!gets(patience)) break;
      const ssize_t count = ::recv(socket_.get(), bytes.data() + done, size - done, 0);
      if (count <= 0) break;
      done += static_cast<std::size_t>(count);
    }
    bytes.resize(done);
    return bytes;
  }
  /// Whether there is something to take, or the end; it is left there.
  bool gets(std::chrono::milliseconds patience = kLong) {
    pollfd ready{socket_.get(), POLLIN, 0};
    return ::poll(&ready, 1, static_cast<int>(patience.count())) == 1;
  }
  /// The server closes, without another byte.
  bool ends() { return gets() && take(1).empty(); }
  void close() { socket_ = FileDescriptor(); }

 private:
  FileDescriptor socket_;
};

/// A scene of which no socket has room for two frames, and one of these.
constexpr std::size_t kMany = 100000;
const Scene kLarge = [] {
  Scene scene = kScene;
  scene.spheres.resize(kMany);
  return scene;
}();
const Frame kLargeFrame = [] {
  Frame frame = small_frame(1);
  frame.centres.resize(3 * kMany);
  return frame;
}();

struct Served {
  ImdServer server;
  ImdEncoder encoder;

  explicit Served(const ImdOptions& options = {}, bool paced = true, const Scene& scene = kScene)
      : server(options), encoder(options.version, scene, true, 1e-3) {
    server.start(scene, true, 1e-3, paced);
  }
  Bytes bytes(const Frame& frame) {
    const auto message = encoder.encode(frame);
    return {message.begin(), message.end()};
  }
  /// One that the server knows to be running, since it gets frames: the newest of them is `tick`.
  void greet(Viewer& viewer) {
    REQUIRE(viewer.take(encoder.greeting().size()) == encoder.greeting());
    REQUIRE(viewer.say(header(3, 0)));
    do server.publish(small_frame(++tick));
    while (viewer.take(1, 20ms).empty());
    const Bytes first = bytes(small_frame(tick));
    viewer.take(first.size() - 1);
    while (!viewer.take(first.size(), 100ms).empty()) {
    }
  }
  std::uint64_t tick = 0;
};

}  // namespace

TEST_CASE("a viewer that pauses gets nothing until it goes on") {
  for (const int version : {2, 3}) {
    Served served({.version = version});
    Viewer viewer(served.server);
    served.greet(viewer);
    const std::size_t size = served.bytes(small_frame(1)).size();
    REQUIRE(viewer.say(header(7, 0)));
    do served.server.publish(small_frame(++served.tick));
    while (!viewer.take(size, 300ms).empty());
    for (int i = 0; i < 5; ++i) served.server.publish(small_frame(++served.tick));
    const std::uint64_t paused = served.tick;
    CHECK(viewer.take(1, 100ms).empty());
    REQUIRE(viewer.say(header(version == 2 ? 7 : 11, 0)));
    Bytes got;
    do served.server.publish(small_frame(++served.tick));
    while ((got = viewer.take(1, 20ms)).empty());
    append(got, viewer.take(size - 1));
    bool newer = false;
    for (std::uint64_t tick = paused + 1; tick <= served.tick; ++tick)
      newer = newer || got == served.bytes(small_frame(tick));
    CHECK(newer);
    viewer.close();
    CHECK(served.server.finish().dropped == 0);
  }
}

TEST_CASE("a client that does not say GO is closed, and so is a ninth one") {
  Served served({.greeting = 100ms});
  Viewer silent(served.server);
  Viewer half(served.server);
  half.say({std::byte{0}, std::byte{0}, std::byte{0}});
  Viewer wrong(served.server);
  wrong.say(header(1, 1));
  for (Viewer* viewer : {&silent, &half, &wrong}) {
    CHECK(viewer->take(8) == served.encoder.greeting());
    CHECK(viewer->ends());
  }
  std::vector<Viewer> viewers;
  for (std::size_t i = 0; i < ImdServer::kMaxClients; ++i) {
    viewers.emplace_back(served.server);
    served.greet(viewers.back());
  }
  Viewer ninth(served.server);
  CHECK(ninth.ends());
  viewers.pop_back();  // its place is free as soon as the server has seen that
  for (const auto begin = Clock::now();;) {
    Viewer next(served.server);
    if (next.take(8).size() == 8) break;
    REQUIRE(Clock::now() - begin < kLong);
  }
}

TEST_CASE("a viewer that does not read misses whole frames, then it is closed; nobody waits") {
  Frame frame = kLargeFrame;
  Served served({.patience = 3s}, /*paced=*/true, kLarge);
  Viewer asleep(served.server, 4096);
  Viewer awake(served.server);
  for (Viewer* viewer : {&asleep, &awake}) {
    REQUIRE(viewer->take(8) == served.encoder.greeting());
    REQUIRE(viewer->say(header(3, 0)));
  }
  const std::size_t size = served.bytes(frame).size();
  const auto begin = Clock::now();
  std::uint64_t tick = 0, last = 0;  // published, and got
  std::uint64_t got = 0;
  // The one that reads gets frames, each of them whole, while the other one is closed.
  while (Clock::now() - begin < 4s || (got < 2 && Clock::now() - begin < kLong)) {
    frame.tick = ++tick;
    frame.centres[0] = static_cast<float>(tick);
    served.server.publish(frame);
    Bytes message = awake.take(size, 50ms);
    if (message.empty()) continue;  // GO was not heard yet
    const Bytes rest = awake.take(size - message.size());
    message.insert(message.end(), rest.begin(), rest.end());
    // On a busy machine it is an earlier frame than the one that was published last.
    Frame sent = frame;
    do {
      sent.tick = ++last;
      sent.centres[0] = static_cast<float>(last);
    } while (last < tick && message != served.bytes(sent));
    REQUIRE((message == served.bytes(sent)));  // as a bool: a megabyte would be printed for ever
    ++got;
  }
  CHECK(got > 1);
  // What it had in its buffers, and the end in the middle of a frame.
  const Bytes rest = asleep.take(100 * size);
  CHECK(rest.size() % size != 0);
  awake.close();
  const ImdCounts counts = served.server.finish();
  CHECK(counts.slow == 1);
  CHECK(counts.dropped > 0);
  CHECK(counts.sent == got);
}

TEST_CASE("without a pace a viewer that does not read is waited for, so long and no longer") {
  Frame frame = kLargeFrame;
  Served served({}, /*paced=*/false, kLarge);
  Viewer asleep(served.server, 4096);
  REQUIRE(asleep.take(8).size() == 8);
  REQUIRE(asleep.say(header(3, 0)));
  REQUIRE(served.server.wait_for_viewer(kLong, kNever));
  const auto begin = Clock::now();
  for (frame.tick = 0; frame.tick < 5; ++frame.tick) served.server.publish(frame);
  CHECK(Clock::now() - begin >= 4 * ImdServer::kWait);  // the first one is on its way at once
  CHECK(Clock::now() - begin < kLong / 2);
  asleep.close();
}

TEST_CASE("a viewer that reads late gets the frame that was on its way, and the newest") {
  Frame frame = kLargeFrame;
  Served served({.patience = kLong}, /*paced=*/true, kLarge);
  Viewer late(served.server, 4096);
  REQUIRE(late.take(8).size() == 8);
  REQUIRE(late.say(header(3, 0)));
  REQUIRE(served.server.wait_for_viewer(kLong, kNever));
  frame.tick = 1;
  served.server.publish(frame);
  REQUIRE(late.gets());
  for (frame.tick = 2; frame.tick < 10; ++frame.tick) served.server.publish(frame);
  const std::size_t size = served.bytes(frame).size();
  for (const std::uint64_t tick : {1, 9}) {
    frame.tick = tick;
    CHECK((late.take(size) == served.bytes(frame)));
  }
  late.close();
  const ImdCounts counts = served.server.finish();
  CHECK(counts.sent == 2);
  CHECK(counts.dropped == 7);
}

TEST_CASE("waiting for a viewer of IMD ends with a signal") {
  Served served;
  std::atomic<int> stop{0};
  std::thread signal([&] {
    std::this_thread::sleep_for(50ms);
    stop = 15;
  });
  CHECK_FALSE(served.server.wait_for_viewer(kLong, stop));
  signal.join();
}
