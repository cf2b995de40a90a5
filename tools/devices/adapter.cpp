#include "tools/devices/adapter.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <iterator>
#include <string_view>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"

namespace hapgrid {

using namespace std::chrono_literals;
using Clock = Hardware::Clock;

namespace {

constexpr auto kIdle = 10ms;  // until the device is read again while no force comes

volatile sig_atomic_t told_to_end = 0;

constexpr int kEnding[] = {SIGTERM, SIGINT, SIGHUP, SIGQUIT};

/// Signals that end a program make it let go of its device. They only come while it waits.
sigset_t catch_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { told_to_end = 1; };
  sigset_t caught, waiting;
  ::sigemptyset(&caught);
  for (const int signal : kEnding) {
    ::sigaction(signal, &action, nullptr);
    ::sigaddset(&caught, signal);
  }
  ::signal(SIGPIPE, SIG_IGN);
  ::sigprocmask(SIG_BLOCK, &caught, &waiting);
  for (const int signal : kEnding) ::sigdelset(&waiting, signal);
  return waiting;
}

/// Waits for a message of play's. @return whether there is one, or the end
bool wait_for_play(Clock::time_point until, const sigset_t& waiting) {
  const auto left = std::clamp<Clock::duration>(until - Clock::now(), 0s, 1h);
  const timespec timeout{left / 1s, (left % 1s) / 1ns};
  pollfd ready{STDIN_FILENO, POLLIN, 0};
  return ::ppoll(&ready, 1, &timeout, &waiting) > 0;
}

void say(const void* message, std::size_t size) {
  (void)!::send(STDOUT_FILENO, message, size, MSG_NOSIGNAL);
}

void answer(Hardware& hardware, hapgrid_device_state& state, std::uint32_t number) {
  hardware.measure(state);
  state.time = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  state.number = number;
  if (number != 0) say(&state, sizeof state);
}

/// From the greeting until the device was let go of.
void serve(Hardware& hardware, const sigset_t& waiting) {
  const hapgrid_device_greeting greeting = hardware.greeting();
  say(&greeting, sizeof greeting);
  hapgrid_device_state state{};
  bool is_zero = true;
  Clock::time_point heard;
  for (;;) {
    const auto quiet = is_zero ? Clock::now() + kIdle : heard + hardware.patience();
    const bool has_message = wait_for_play(std::min(quiet, hardware.due()), waiting);
    if (told_to_end) break;
    if (has_message) {
      hapgrid_device_force force;
      const ssize_t got = ::recv(STDIN_FILENO, &force, sizeof force, MSG_DONTWAIT);
      if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (got != sizeof force) break;  // play is gone
      heard = Clock::now();
      if ((force.flags & HAPGRID_DEVICE_END) != 0) {
        hardware.let_go();
        return answer(hardware, state, force.number);
      }
      if ((force.flags & HAPGRID_DEVICE_SNAP) != 0) hardware.snap();
      const Vec3 newtons{force.force[0], force.force[1], force.force[2]};
      is_zero = newtons == Vec3{0, 0, 0};
      hardware.apply(newtons);
      answer(hardware, state, force.number);
    } else if (!is_zero && Clock::now() >= heard + hardware.patience()) {
      hardware.apply({0, 0, 0});
      is_zero = true;
    } else if (is_zero) {
      hardware.measure(state);  // so that no position is old when play begins
    }
    if (Clock::now() >= hardware.due()) hardware.work();
  }
  hardware.let_go();
  if (told_to_end) throw Error("ended by a signal, and let go of the device");
}

void speak_protocol(const AdapterKind& kind, const AdapterWords& words) {
  const sigset_t waiting = catch_signals();
  const std::unique_ptr<Hardware> hardware = kind.open(words);
  try {
    serve(*hardware, waiting);
  } catch (const std::exception&) {
    try {
      if (!told_to_end) hardware->let_go();
    } catch (const std::exception&) {  // the first failure is the one to be told
    }
    throw;
  }
}

void print_list(const AdapterKind& kind) {
  for (const ListedDevice& device : kind.list())
    std::printf("%s\t%s\t%s\t%s\n", device.device.c_str(), device.feels.c_str(),
                device.name.c_str(), device.forbidden.c_str());
}

}  // namespace

bool is_told_to_end() {
  sigset_t come;
  ::sigpending(&come);
  return told_to_end || std::any_of(std::begin(kEnding), std::end(kEnding),
                                    [&](int signal) { return ::sigismember(&come, signal) == 1; });
}

int adapter_main(int argc, char** argv, const AdapterKind& kind) {
  AdapterWords words;
  std::string what;
  bool is_wrong = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--release" || word == "--list" || word == "--help")
      what = word;
    else if (word == "--rate" && i + 1 < argc)
      is_wrong = !parse_number(argv[++i], words.rate) || is_wrong;
    else
      words.words.push_back(word);
  }
  const char* const name = program_invocation_short_name;
  // The socket, which keeps the boundaries of messages.
  int type = 0;
  socklen_t size = sizeof type;
  const bool is_socket = ::getsockopt(STDIN_FILENO, SOL_SOCKET, SO_TYPE, &type, &size) == 0;
  if (is_wrong || what == "--help" || (what.empty() && (!is_socket || type != SOCK_SEQPACKET))) {
    std::fprintf(what == "--help" ? stdout : stderr,
                 "%s is an adapter, which play starts: play GRID --device DEVICE\n"
                 "usage: %s %s\n"
                 "       [--rate HZ] [--release]\n"
                 "       %s --list\n",
                 name, name, kind.usage, name);
    return what == "--help" ? 0 : 2;
  }
  try {
    if (what == "--list")
      print_list(kind);
    else if (what == "--release")
      kind.release(words);
    else
      speak_protocol(kind, words);
    return 0;
  } catch (const std::exception& e) {
    const std::string why = printable_line(e.what(), 480);
    if (what.empty()) {
      const std::string message = HAPGRID_DEVICE_ERROR + why;
      say(message.data(), message.size());
    } else {
      std::fprintf(stderr, "%s: %s\n", name, why.c_str());
    }
    return 1;
  }
}

hapgrid_device_greeting made_greeting(const std::string& name, const Vec3& low, const Vec3& high,
                                      double max_force, double rate, std::uint32_t flags) {
  hapgrid_device_greeting greeting{.magic = HAPGRID_DEVICE_MAGIC,
                                   .version = HAPGRID_DEVICE_VERSION,
                                   .flags = flags | HAPGRID_DEVICE_SHARES,
                                   .low = {low[0], low[1], low[2]},
                                   .high = {high[0], high[1], high[2]},
                                   .max_force = max_force,
                                   .rate = rate,
                                   .name = {}};
  std::size_t size = std::min(name.size(), sizeof greeting.name);
  // A letter of several bytes is whole or left out.
  while (size < name.size() && size > 0 && (name[size] & 0xc0) == 0x80) --size;
  std::memcpy(greeting.name, name.data(), size);
  return greeting;
}

}  // namespace hapgrid
