#include "libcore/device/hid_guard.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/device/hid_handle.hpp"

namespace hapgrid {

using namespace std::chrono_literals;

namespace {

// Messages of the socket, which keeps their boundaries. To the child: 'g', the goodbye, alone; or
// 'w', the path, a zero byte, and each report after its length (two bytes). Back: 'k' (an empty
// message would look like the end of the socket), or 'e' and why the device cannot be opened.
constexpr char kGoodbye = 'g', kWatch = 'w', kDone = 'k', kRefused = 'e';
constexpr std::size_t kMaxMessage = 1 << 16;
constexpr int kTries = 5;
constexpr auto kBetweenTries = 50ms;

struct Watched {
  std::string path;
  std::vector<HidReport> stop;
  std::unique_ptr<HidWire> handle;
};

/// @throw DeviceError
void take(std::string_view message, Watched& watched) {
  const std::size_t end = message.find('\0');
  if (end == message.npos) throw DeviceError("no path");
  const std::string path(message.substr(0, end));
  message.remove_prefix(end + 1);
  std::vector<HidReport> stop;
  while (message.size() >= 2) {
    const std::size_t size = static_cast<unsigned char>(message[0]) |
                             std::size_t{static_cast<unsigned char>(message[1])} << 8;
    const std::string_view bytes = message.substr(2, size);
    stop.emplace_back(bytes.begin(), bytes.end());
    message.remove_prefix(2 + bytes.size());
  }
  if (!watched.handle || watched.path != path) watched.handle = open_wire(path);
  watched.path = path;
  watched.stop = std::move(stop);
}

/// Tries every report, also after one that the device did not take.
bool write_all(Watched& watched) {
  bool all = true;
  for (const HidReport& report : watched.stop) all = watched.handle->try_write(report) && all;
  return all;
}

void let_go(Watched& watched) {
  if (!watched.handle) return;
  for (int i = 0; i < kTries && !write_all(watched); ++i)
    std::this_thread::sleep_for(kBetweenTries);
}

/// What the child does all its life.
void guard(int socket, Heart& heart) {
  std::vector<char> buffer(kMaxMessage);
  Watched watched;
  for (;;) {
    wait_for_message(socket, heart, [&watched] { let_go(watched); });
    const ssize_t got = ::recv(socket, buffer.data(), buffer.size(), 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return let_go(watched);
    if (buffer[0] == kGoodbye) return;
    std::string answer(1, kDone);
    try {
      take({buffer.data() + 1, static_cast<std::size_t>(got) - 1}, watched);
    } catch (const std::exception& e) {
      answer = kRefused + std::string(e.what());
    }
    (void)!::send(socket, answer.data(), answer.size(), MSG_NOSIGNAL);
  }
}

}  // namespace

HidGuard::HidGuard() : process_("hapgrid-guard", {}, guard) {}

void HidGuard::watch(const std::string& path, const std::vector<HidReport>& stop) {
  std::string message = kWatch + path + '\0';
  for (const HidReport& report : stop) {
    if (report.size() > kMaxHidReport) throw DeviceError(path + ": a stop report is too long");
    message += {static_cast<char>(report.size() & 255), static_cast<char>(report.size() >> 8)};
    message.append(report.begin(), report.end());
  }
  if (message.size() > kMaxMessage || path.find('\0') != path.npos)
    throw DeviceError(path + ": too many stop reports for the guard process");
  char answer[512];
  const ssize_t got = process_.ask(message, answer);
  if (got <= 0) throw DeviceError(path + ": the guard process does not answer");
  if (answer[0] != kDone)
    throw DeviceError("the guard process: " +
                      std::string(answer + 1, static_cast<std::size_t>(got) - 1));
}

void HidGuard::release() noexcept { (void)!::send(process_.socket(), &kGoodbye, 1, MSG_NOSIGNAL); }

}  // namespace hapgrid
