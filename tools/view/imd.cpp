// One thread accepts viewers, listens to them, and sends. A viewer gets whole frames: while one is
// on its way, the newest frame waits, and replaces the one that waited before.

#include "tools/view/imd.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <memory>
#include <system_error>
#include <thread>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/scene/imd_protocol.hpp"
#include "tools/common/tool.hpp"
#include "tools/view/feed.hpp"

namespace hapgrid {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::size_t kMostViewers = 8;
// Until GO. The protocol asks for one second; the second one is for slow machines.
constexpr auto kGreeting = 2s;
constexpr auto kPatience = 5s;        // with a viewer that reads one frame
constexpr auto kReadRest = 1s;        // for viewers to read the rest
constexpr int kSendBuffer = 1 << 16;  // bytes; small, so that nobody sees what is long past
// Also the number of viewers that are accepted in a cycle, even if most are closed at once: a flood
// of them must not fill the queue in which a good one waits.
constexpr int kBacklog = 128;
constexpr std::size_t kHeardBytes = 4096;  // of a viewer, a cycle
constexpr auto kCycle = 1ms;               // at least, between two looks at what viewers sent
constexpr int kLookMs = 50;                // at most, between two looks at the clock

[[noreturn]] void fail_imd(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

bool would_block() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

using Address = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

/// Null when the address is not in numbers.
Address parse(const std::string& address, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* result = nullptr;
  if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &result) != 0)
    result = nullptr;
  return Address(result, &::freeaddrinfo);
}

std::uint16_t port_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) fail_imd("IMD");
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

/// A port that is open, and its name: "127.0.0.1:8888", "[::1]:8888".
std::pair<FileDescriptor, std::string> listen_at(const std::string& place) {
  const auto [host, number] = *read_imd(place);
  const bool six = host.find(':') != std::string::npos;
  const std::string shown = six ? "[" + host + "]" : host;
  const Address address = parse(host, number);
  FileDescriptor port(
      ::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP));
  const int on = 1;
  if (!port || ::setsockopt(port.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::setsockopt(port.get(), SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer) != 0 ||
      ::bind(port.get(), address->ai_addr, address->ai_addrlen) != 0 ||
      ::listen(port.get(), kBacklog) != 0)
    fail_imd(format("{}:{}", shown, number));
  const std::uint16_t chosen = port_of(port.get());
  return {std::move(port), format("{}:{}", shown, chosen)};
}

struct Viewer {
  FileDescriptor socket;
  ImdListener listener;
  Clock::time_point since = Clock::now();           // accepted; went on; a frame began
  std::vector<std::byte> message = imd_greeting();  // on its way: the greeting or a frame
  std::size_t sent = 0;                             // bytes of it
  bool greeted = false;                             // the message is a frame
  bool behind = false;                              // it has yet to get the newest frame
  bool told_end = false;
  bool dead = false;

  bool running() const { return listener.state() == ImdListener::State::kRunning; }
};

class ImdServer {
 public:
  explicit ImdServer(const std::string& place) : port_(listen_at(place)) {
    if (!woken_) fail_imd("eventfd");
    say("view", "IMD on " + port_.second);
  }
  void run(const std::string& frames);

 private:
  void wait();
  void take_frames();
  void accept_viewers();
  void listen_to(Viewer& viewer);
  void send_to(Viewer& viewer);
  void check(Viewer& viewer, Clock::time_point now);
  void say_once(bool& said, const std::string& text);

  std::pair<FileDescriptor, std::string> port_;
  FileDescriptor woken_{::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)};
  std::optional<Feed> feed_;
  bool started_ = false;
  bool any_frame_ = false;
  std::optional<Clock::time_point> end_;  // when the last frame came
  std::vector<Viewer> viewers_;
  std::vector<std::byte> newest_;  // frame
  std::uint64_t came_ = 0, sent_ = 0, slow_ = 0;
  bool said_forces_ = false, said_rate_ = false, said_full_ = false;
};

void ImdServer::run(const std::string& frames) {
  feed_.emplace(frames, [this] {
    const std::uint64_t one = 1;
    static_cast<void>(!::write(woken_.get(), &one, sizeof one));
  });
  const Scene& scene = feed_->scene();
  const ImdUnits units(scene);
  const auto say_unit = [](const char* what, const std::string& unit, const char* taken_for) {
    say("view", format("IMD: {} go out in {}, viewers take them for {}", what,
                       unit.empty() ? "a unit without a name" : unit, taken_for));
  };
  if (!units.length_known) say_unit("lengths", scene.length_unit, "angstrom");
  if (!units.energy_known && !scene.energy_unit.empty())
    say_unit("energies", scene.energy_unit, "kcal/mol");
  while (!end_ || (!viewers_.empty() && Clock::now() < *end_ + kReadRest)) {
    if (!started_ && (!feed_->recorded() || came_ > 0)) {
      feed_->start();
      started_ = true;
    }
    wait();
    take_frames();
    const auto now = Clock::now();
    for (Viewer& viewer : viewers_) {
      listen_to(viewer);
      send_to(viewer);
      check(viewer, now);
    }
    std::erase_if(viewers_, [](const Viewer& viewer) { return viewer.dead; });
    accept_viewers();
  }
  feed_->check();
  if (!any_frame_) throw Error(format("{}: no frame in it, nothing to show", feed_->name()));
  say("view", format("IMD viewers {}, frames sent {}; closed because they did not read {}", came_,
                     sent_, slow_));
}

/// For frames, viewers, or the clock. Whatever viewers do, the work of a cycle is bounded, and a
/// cycle lasts a while.
void ImdServer::wait() {
  std::vector<pollfd> polled{{woken_.get(), POLLIN, 0}, {port_.first.get(), POLLIN, 0}};
  for (const Viewer& viewer : viewers_)
    polled.push_back({viewer.socket.get(),
                      static_cast<short>(viewer.message.empty() ? POLLIN : POLLIN | POLLOUT), 0});
  const int ready = ::poll(polled.data(), polled.size(), viewers_.empty() ? -1 : kLookMs);
  if (ready < 0 && errno != EINTR) fail_imd("IMD: poll");
  std::uint64_t count;
  static_cast<void>(!::read(woken_.get(), &count, sizeof count));
  if (ready > 0 && std::any_of(polled.begin() + 1, polled.end(),
                               [](const pollfd& p) { return p.revents & ~POLLOUT; }))
    std::this_thread::sleep_for(kCycle);
}

void ImdServer::take_frames() {
  Feed::State state;
  Frame frame;
  do {
    state = feed_->update(frame);
    if (!state.fresh) break;
    any_frame_ = true;
    newest_ = imd_frame(frame, ImdUnits(feed_->scene()));
    for (Viewer& viewer : viewers_) {
      viewer.behind = viewer.greeted && viewer.running();
      send_to(viewer);
    }
  } while (state.more);
  if (state.ended && !end_) end_ = Clock::now();
}

void ImdServer::accept_viewers() {
  for (int i = 0; i < kBacklog && !end_; ++i) {
    FileDescriptor socket(
        ::accept4(port_.first.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    // Also where there are too many open files, or it has gone again: the next cycle looks again.
    if (!socket) return;
    if (viewers_.size() >= kMostViewers) {  // this one is closed
      say_once(said_full_,
               format("one more viewer came and was sent away: {} can watch", kMostViewers));
      continue;
    }
    const int on = 1;
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    viewers_.push_back(
        {.socket = std::move(socket), .listener = ImdListener(feed_->scene().spheres.size() + 1)});
    send_to(viewers_.back());
  }
}

void ImdServer::listen_to(Viewer& viewer) {
  std::array<std::byte, kHeardBytes> bytes;
  const ssize_t count = ::recv(viewer.socket.get(), bytes.data(), bytes.size(), 0);
  if (count <= 0) {
    viewer.dead = viewer.dead || count == 0 || !would_block();
    return;
  }
  using State = ImdListener::State;
  const State before = viewer.listener.state();
  const State after = viewer.listener.read(std::span(bytes).first(static_cast<std::size_t>(count)));
  if (viewer.listener.sent_forces())
    say_once(said_forces_,
             "a viewer sends forces; they are ignored, since the hand alone moves the model");
  if (viewer.listener.sent_rate())
    say_once(said_rate_,
             "a viewer asks for another rate (TRATE); it gets each frame that play makes");
  viewer.dead = viewer.dead || after == State::kClosed;
  if (before == State::kGreeted && after != before && !viewer.dead) ++came_;
  if (before != State::kRunning && viewer.running()) viewer.since = Clock::now();
}

/// Sends as much as the system takes at once; frames follow each other.
void ImdServer::send_to(Viewer& viewer) {
  while (!viewer.dead) {
    if (viewer.message.empty()) {
      if (!viewer.behind || !viewer.running()) break;
      viewer.behind = false;
      viewer.message = newest_;
      viewer.sent = 0;
      viewer.since = Clock::now();
    }
    const auto rest = std::span(viewer.message).subspan(viewer.sent);
    const ssize_t count = ::send(viewer.socket.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
    if (count < 0) {
      viewer.dead = !would_block();
      return;
    }
    viewer.sent += static_cast<std::size_t>(count);
    if (viewer.sent < viewer.message.size()) continue;
    viewer.message.clear();
    sent_ += viewer.greeted;
    viewer.greeted = true;
  }
  if (!end_ || viewer.told_end || viewer.dead) return;
  ::shutdown(viewer.socket.get(), SHUT_WR);
  viewer.told_end = true;
}

/// Closes a viewer that takes too long.
void ImdServer::check(Viewer& viewer, Clock::time_point now) {
  const bool silent =
      viewer.listener.state() == ImdListener::State::kGreeted && now - viewer.since > kGreeting;
  const bool slow = viewer.running() && !viewer.message.empty() && now - viewer.since > kPatience;
  slow_ += slow && !viewer.dead;
  viewer.dead = viewer.dead || silent || slow;
}

void ImdServer::say_once(bool& said, const std::string& text) {
  if (!said) say("view", "IMD: " + text);
  said = true;
}

}  // namespace

std::optional<std::pair<std::string, std::uint16_t>> read_imd(const std::string& text) {
  std::pair<std::string, std::uint16_t> place{"127.0.0.1", 0};
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == text.npos ? text : text.substr(colon + 1);
  if (colon != text.npos) {
    std::string& address = place.first;
    address = text.substr(0, colon);
    const bool six = address.starts_with('[') && address.ends_with(']');
    if (six) address = address.substr(1, address.size() - 2);
    if (six != (address.find(':') != text.npos) || !parse(address, 0)) return std::nullopt;
  }
  const char* const end = port.data() + port.size();
  const auto read = std::from_chars(port.data(), end, place.second);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return place;
}

void run_imd(const std::string& frames, const std::string& place) { ImdServer(place).run(frames); }

}  // namespace hapgrid
