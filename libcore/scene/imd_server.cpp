#include "libcore/scene/imd_server.hpp"

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
#include <memory>
#include <system_error>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/signals.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

constexpr int kSendBuffer = 1 << 16;  // bytes; small, so that nobody sees what is long past
// Also the number of clients that are accepted in a cycle, even if most are closed at once: a flood
// of them must not fill the queue in which a good client waits.
constexpr int kBacklog = 128;
constexpr std::size_t kClientBytes = 4096;  // of a client, a cycle
constexpr auto kCycle = 1ms;                // at least, between two looks at what clients sent
constexpr int kLookMs = 50;                 // at most, between two looks at the clock

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

using Address = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Address parse(const std::string& address, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* result = nullptr;
  if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &result) != 0)
    result = nullptr;
  return Address(result, &::freeaddrinfo);
}

std::string name_of(const std::string& address, std::uint16_t port) {
  const bool six = address.find(':') != std::string::npos;
  return six ? format("[{}]:{}", address, port) : format("{}:{}", address, port);
}

std::uint16_t port_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) fail("IMD");
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

bool would_block() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

bool ImdServer::is_address(const std::string& address) { return parse(address, 0) != nullptr; }

ImdServer::ImdServer(const ImdOptions& options)
    : options_(options), name_(name_of(options.address, options.port)) {
  const Address address = parse(options.address, options.port);
  if (!address) throw Error(format("{}: not an address in numbers", options.address));
  port_ = FileDescriptor(
      ::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, IPPROTO_TCP));
  const int on = 1;
  const int buffer = kSendBuffer;  // inherited by what is accepted
  if (!port_ || ::setsockopt(port_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::setsockopt(port_.get(), SOL_SOCKET, SO_SNDBUF, &buffer, sizeof buffer) != 0 ||
      ::bind(port_.get(), address->ai_addr, address->ai_addrlen) != 0 ||
      ::listen(port_.get(), kBacklog) != 0)
    fail(name_);
  name_ = name_of(options.address, port_of(port_.get()));
  wake_ = FileDescriptor(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
  if (!wake_) fail(name_);
  clients_.reserve(kMaxClients);
}

ImdServer::~ImdServer() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake();
  thread_.join();
}

void ImdServer::start(const Scene& scene, bool has_energy, double tick_s, bool paced) {
  encoder_.emplace(options_.version, scene, has_energy, tick_s);
  atoms_ = scene.spheres.size() + 1;
  paced_ = paced;
  const BlockedSignals blocked;
  thread_ = std::thread([this] {
    try {
      run();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      clients_.clear();
      changed_.notify_all();
    }
  });
}

bool ImdServer::wait_for_viewer(std::chrono::duration<double> time, const std::atomic<int>& stop) {
  const auto begin = Clock::now();
  std::unique_lock lock(mutex_);
  const auto none = [](const Client& client) { return !client.running(); };
  while (all_clients(none) && !failure_) {
    // A signal's handler cannot wake anybody here.
    if (stop.load(std::memory_order_relaxed) != 0 || Clock::now() - begin >= time) return false;
    changed_.wait_for(lock, 20ms);
  }
  return !failure_;
}

void ImdServer::publish(const Frame& frame) {
  std::unique_lock lock(mutex_);
  const auto message = encoder_->encode(frame);
  newest_.assign(message.begin(), message.end());
  ++number_;
  for (Client& client : clients_) send_to(client);
  wake();
  if (paced_) return;
  changed_.wait_for(lock, kWait, [&] {
    return all_clients(
        [&](const Client& client) { return !client.running() || client.seen == number_; });
  });
}

ImdCounts ImdServer::counts() {
  const std::lock_guard lock(mutex_);
  return counts_;
}

ImdCounts ImdServer::finish() {
  std::unique_lock lock(mutex_);
  ending_ = true;
  wake();
  changed_.wait_for(lock, kLinger, [&] { return clients_.empty(); });
  stop_ = true;
  lock.unlock();
  wake();
  if (thread_.joinable()) thread_.join();
  for (const Client& client : clients_)
    if (client.running()) counts_.dropped += number_ - client.seen;
  clients_.clear();
  port_ = FileDescriptor();
  if (failure_) std::rethrow_exception(failure_);
  return counts_;
}

void ImdServer::wake() noexcept {
  const std::uint64_t one = 1;
  (void)!::write(wake_.get(), &one, sizeof one);  // full: then it is awake
}

template <class Predicate>
bool ImdServer::all_clients(Predicate&& predicate) const {
  return std::all_of(clients_.begin(), clients_.end(), predicate);
}

/// The thread. Whatever clients do, the work of a cycle is bounded: the number of clients, the
/// bytes of each, and the new clients. A cycle lasts a while, in which others get the lock.
void ImdServer::run() {
  std::vector<pollfd> polled;
  std::unique_lock lock(mutex_);
  while (!stop_) {
    polled.assign({{wake_.get(), POLLIN, 0}, {ending_ ? -1 : port_.get(), POLLIN, 0}});
    for (const Client& client : clients_)
      polled.push_back({client.socket.get(),
                        static_cast<short>(client.message.empty() ? POLLIN : POLLIN | POLLOUT), 0});
    const int timeout = clients_.empty() ? -1 : kLookMs;
    lock.unlock();
    const int ready = ::poll(polled.data(), polled.size(), timeout);
    if (ready < 0 && errno != EINTR) fail("IMD: poll");
    std::uint64_t ignored;
    (void)!::read(wake_.get(), &ignored, sizeof ignored);
    if (ready > 0 && std::any_of(polled.begin() + 1, polled.end(),
                                 [](const pollfd& p) { return p.revents & ~POLLOUT; }))
      std::this_thread::sleep_for(kCycle);
    lock.lock();

    const auto now = Clock::now();
    for (Client& client : clients_) {
      listen_to(client);
      send_to(client);
      check(client, now);
    }
    std::erase_if(clients_, [](const Client& client) { return client.dead; });
    if (!ending_) accept_clients();
    changed_.notify_all();
  }
}

void ImdServer::accept_clients() {
  for (int i = 0; i < kBacklog; ++i) {
    FileDescriptor socket(::accept4(port_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    // Also where there are too many open files, or it has gone again: the next cycle looks again.
    if (!socket) return;
    if (clients_.size() >= kMaxClients) {
      ++counts_.refused;  // closed
      continue;
    }
    const int on = 1;
    ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    clients_.push_back({.socket = std::move(socket),
                        .listener = ImdListener(options_.version, atoms_),
                        .since = Clock::now(),
                        .message = encoder_->greeting()});
    send_to(clients_.back());
  }
}

void ImdServer::listen_to(Client& client) {
  if (client.dead) return;
  std::array<std::byte, kClientBytes> bytes;
  const ssize_t count = ::recv(client.socket.get(), bytes.data(), bytes.size(), 0);
  if (count < 0) {
    if (!would_block()) client.dead = true;
    return;
  }
  using State = ImdListener::State;
  const State before = client.listener.state();
  const ImdListener::Ignored ignored = client.listener.ignored();
  const State after = client.listener.read(std::span(bytes).first(static_cast<std::size_t>(count)));
  counts_.forces += client.listener.ignored().forces - ignored.forces;
  counts_.rates += client.listener.ignored().rates - ignored.rates;
  if (count == 0 || after == State::kClosed) client.dead = true;
  if (before == State::kGreeted && after != State::kGreeted && !client.dead) ++counts_.viewers;
  if (before != State::kRunning && after == State::kRunning) {
    client.seen = number_;  // it gets only frames that follow
    client.since = Clock::now();
  }
}

/// Sends as much as the system takes at once; frames follow each other.
void ImdServer::send_to(Client& client) {
  while (!client.dead && !client.ended) {
    if (client.message.empty()) {
      if (!client.running() || client.seen == number_) {
        if (!ending_) return;
        ::shutdown(client.socket.get(), SHUT_WR);
        client.ended = true;
        return;
      }
      counts_.dropped += number_ - client.seen - 1;
      client.seen = number_;
      client.message = newest_;
      client.sent = 0;
      client.since = Clock::now();
    }
    const auto rest = std::span(client.message).subspan(client.sent);
    const ssize_t count = ::send(client.socket.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
    if (count < 0) {
      if (!would_block()) client.dead = true;
      return;
    }
    client.sent += static_cast<std::size_t>(count);
    if (client.sent < client.message.size()) continue;
    client.message.clear();
    if (client.greeted) ++counts_.sent;
    client.greeted = true;
  }
}

/// Closes a client that takes too long.
void ImdServer::check(Client& client, Clock::time_point now) {
  using State = ImdListener::State;
  if (client.dead) return;
  const State state = client.listener.state();
  if (state == State::kGreeted && now - client.since > options_.greeting) client.dead = true;
  if (state == State::kRunning && !client.message.empty() &&
      now - client.since > options_.patience) {
    client.dead = true;
    ++counts_.slow;
    counts_.dropped += number_ - client.seen;
  }
}

}  // namespace hapgrid
