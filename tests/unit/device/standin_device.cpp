#include "tests/unit/device/standin_device.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

StandinDevice::StandinDevice(const std::string& socket) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket.size() >= sizeof address.sun_path) throw std::runtime_error("socket path");
  std::strcpy(address.sun_path, socket.c_str());
  listener_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener_, 16) != 0)
    throw std::runtime_error("socket");
  ::setenv("HAPGRID_STANDIN", socket.c_str(), 1);
  thread_ = std::thread([this] { run(); });
}

StandinDevice::~StandinDevice() {
  stop_flood();
  end_ = true;
  thread_.join();
  for (const Connection& c : connections_) ::close(c.fd);
  if (listener_ >= 0) ::close(listener_);
}

void StandinDevice::run() {
  while (!end_) {
    std::vector<pollfd> fds;
    {
      const std::lock_guard lock(mutex_);
      if (!gone_) fds.push_back({listener_, POLLIN, 0});
      for (const Connection& c : connections_) fds.push_back({c.fd, POLLIN, 0});
    }
    ::poll(fds.data(), fds.size(), 5);
    const std::lock_guard lock(mutex_);
    if (gone_) continue;
    for (const pollfd& fd : fds) {
      if (fd.revents == 0) continue;
      if (fd.fd == listener_) {
        connections_.push_back({::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC), 0});
        continue;
      }
      for (Connection& c : connections_)
        if (c.fd == fd.fd) take(c);
    }
    std::erase_if(connections_, [](const Connection& c) { return c.fd < 0; });
  }
}

void StandinDevice::take(Connection& c) {
  char message[8192];
  const ssize_t got = ::recv(c.fd, message, sizeof message, MSG_DONTWAIT);
  if (got <= 0) {
    std::erase_if(held_, [&](const Held& held) { return held.fd == c.fd; });
    ::close(c.fd);
    c.fd = -1;
    return;
  }
  const Bytes bytes(message + 1, message + got);
  if (c.kind == 0) {
    c.kind = message[0];
    if (c.kind == 'L') ::send(c.fd, list_.data(), list_.size(), MSG_NOSIGNAL);
    if (c.kind == 'C') {
      const std::string hello = refusal_.empty() ? "k" : "e" + refusal_;
      ++opened_;
      ::send(c.fd, hello.data(), hello.size(), MSG_NOSIGNAL);
    }
    if (c.kind == 'I')
      for (const Bytes& report : kept_) {
        const std::string input = "i" + std::string(report.begin(), report.end());
        ::send(c.fd, input.data(), input.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      }
  } else if (message[0] == 'w') {
    written_.push_back(bytes);
    if (std::find(writers_.begin(), writers_.end(), c.fd) == writers_.end())
      writers_.push_back(c.fd);
    if (holding_) {
      held_.push_back({c.fd, bytes.size()});
    } else if (answers_ > 0) {
      --answers_;
      answer(c.fd, answer_, answer_text_);
    } else {
      answer(c.fd, static_cast<std::int32_t>(bytes.size()), "");
    }
  } else if (message[0] == 'f') {
    answer(c.fd, static_cast<std::int32_t>(bytes.size()), "");
  }
}

void StandinDevice::answer(int fd, std::int32_t n, const std::string& text) {
  std::string message(5, 'r');
  std::memcpy(message.data() + 1, &n, sizeof n);
  message += text;
  ::send(fd, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

/// As hidraw: what finds no room is dropped.
void StandinDevice::send_inputs(const std::string& message) {
  const std::lock_guard lock(mutex_);
  for (const Connection& c : connections_)
    if (c.kind == 'I') ::send(c.fd, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

void StandinDevice::input(const Bytes& report, bool kept) {
  if (kept) locked([&] { kept_.push_back(report); });
  send_inputs("i" + std::string(report.begin(), report.end()));
}

void StandinDevice::read_error(const std::string& text) { send_inputs("e" + text); }

void StandinDevice::read_sleep(int milliseconds) {
  const std::int32_t n = milliseconds;
  std::string message(5, 's');
  std::memcpy(message.data() + 1, &n, sizeof n);
  send_inputs(message);
}

void StandinDevice::flood(const Bytes& report) {
  flooding_ = true;
  flood_ = std::thread([this, report] {
    const std::string message = "i" + std::string(report.begin(), report.end());
    // More than there is room for, and between two of them room for the lock's other users.
    while (flooding_) {
      for (int i = 0; i < 64; ++i) send_inputs(message);
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  });
}

void StandinDevice::stop_flood() {
  flooding_ = false;
  if (flood_.joinable()) flood_.join();
}

void StandinDevice::vanish() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  for (const Connection& c : connections_) ::close(c.fd);
  connections_.clear();
  ::close(listener_);
  listener_ = -1;
}

void StandinDevice::release_writes() {
  const std::lock_guard lock(mutex_);
  holding_ = false;
  for (const Held& held : held_) answer(held.fd, static_cast<std::int32_t>(held.size), "");
  held_.clear();
}

bool StandinDevice::wait(const std::function<bool()>& condition) const {
  using namespace std::chrono_literals;
  for (const auto deadline = std::chrono::steady_clock::now() + 10s; !condition();) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}
