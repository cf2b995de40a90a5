#include "tools/view/screen.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>
#include <system_error>

namespace hapgrid {

namespace {

// Handlers get no arguments of ours.
volatile sig_atomic_t ending = 0;
volatile sig_atomic_t stop_asked = 0;
volatile sig_atomic_t size_changed = 0;
volatile sig_atomic_t wake_fd = -1;

extern "C" void on_signal(int signal) {
  const int error = errno;
  if (signal == SIGWINCH)
    size_changed = 1;
  else if (signal == SIGTSTP)
    stop_asked = 1;
  else
    ending = signal;
  wake();
  errno = error;
}

bool read_and_clear(volatile sig_atomic_t& flag) {
  const bool was = flag;
  if (was) flag = 0;
  return was;
}

}  // namespace

TerminalSize terminal_size() {
  TerminalSize size;
  winsize w{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &w) != 0 || w.ws_col == 0 || w.ws_row == 0) return size;
  size.columns = std::min<int>(w.ws_col, 1000);
  size.rows = std::min<int>(w.ws_row, 1000);
  if (w.ws_xpixel >= w.ws_col && w.ws_ypixel >= w.ws_row) {
    size.cell_width = std::clamp(w.ws_xpixel / w.ws_col, 1, 64);
    size.cell_height = std::clamp(w.ws_ypixel / w.ws_row, 1, 128);
  }
  return size;
}

void watch_signals(int eventfd) {
  wake_fd = eventfd;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGWINCH}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;
    // Without SA_RESTART: a terminal that takes nothing must not keep us from ending.
    struct sigaction action {};
    action.sa_handler = on_signal;
    ::sigaction(signal, &action, nullptr);
  }
}

void wake() {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_fd, &one, sizeof one));
}

int ending_signal() { return ending; }
bool stop_was_asked() { return read_and_clear(stop_asked); }
bool size_was_changed() { return read_and_clear(size_changed); }

void die_of(int signal) {
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

void Screen::enter() {
  entered_ = true;
  write("\033[?1049h\033[?25l\033[H\033[2J");
}

void Screen::leave() noexcept {
  if (!entered_) return;
  entered_ = false;
  // A string terminator and the end of what appears at once, for what may be unfinished; then
  // colours, cursor, screen.
  constexpr std::string_view kText = "\033\\\033[?2026l\033[0m\033[?25h\033[?1049l";
  static_cast<void>(!::write(STDOUT_FILENO, kText.data(), kText.size()));
}

void Screen::write(std::string_view text) {
  while (!text.empty() && !ending) {
    const ssize_t count = ::write(STDOUT_FILENO, text.data(), text.size());
    if (count < 0 && errno == EAGAIN) {
      // Another program has set the terminal not to wait.
      pollfd terminal{STDOUT_FILENO, POLLOUT, 0};
      ::poll(&terminal, 1, -1);
    } else if (count < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "standard output");
    }
    if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace hapgrid
