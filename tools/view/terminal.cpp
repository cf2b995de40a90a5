#include "tools/view/terminal.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <system_error>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/scene/render.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/pixels.hpp"

namespace hapgrid {

namespace {

// ---- signals
// -------------------------------------------------------------------------------------

constexpr std::array kEnding = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};

// Handlers get no arguments of ours.
volatile sig_atomic_t ending_signal = 0;
volatile sig_atomic_t stop_asked = 0;
volatile sig_atomic_t size_changed = 0;
volatile sig_atomic_t wake_fd = -1;

void wake() {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(wake_fd, &one, sizeof one));
}

extern "C" void on_signal(int signal) {
  const int error = errno;
  if (signal == SIGWINCH)
    size_changed = 1;
  else if (signal == SIGTSTP)
    stop_asked = 1;
  else
    ending_signal = signal;
  wake();
  errno = error;
}

void handle(int signal) {
  struct sigaction before {};
  ::sigaction(signal, nullptr, &before);
  if (before.sa_handler == SIG_IGN) return;  // as nohup wants it
  // Without SA_RESTART: a terminal that takes nothing must not keep us from ending.
  struct sigaction action {};
  action.sa_handler = on_signal;
  ::sigaction(signal, &action, nullptr);
}

void die_of(int signal) {
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

// ---- the terminal
// --------------------------------------------------------------------------------

/// Columns, rows, and a cell's size in pixels, which many terminals do not tell.
struct Size {
  int columns = 80;
  int rows = 24;
  int cell_width = 8;
  int cell_height = 16;
};

Size terminal_size() {
  Size size;
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

/// The other screen of the terminal, without a cursor, while it is in use.
class Screen {
 public:
  explicit Screen(bool kitty) : kitty_(kitty) { enter(); }
  ~Screen() { leave(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void enter() {
    entered_ = true;
    write("\033[?1049h\033[?25l\033[H\033[2J");
  }
  /// Also from the middle of a sequence that was not written to its end.
  void leave() noexcept {
    if (!entered_) return;
    entered_ = false;
    const std::string text = std::string("\033\\\033[?2026l\033[0m") +
                             (kitty_ ? "\033_Ga=d\033\\" : "") + "\033[?25h\033[?1049l";
    static_cast<void>(!::write(STDOUT_FILENO, text.data(), text.size()));
  }
  /// The rest is left out once a signal wants the process to end.
  /// @throw std::system_error
  void write(std::string_view text) {
    while (!text.empty() && !ending_signal) {
      const ssize_t count = ::write(STDOUT_FILENO, text.data(), text.size());
      if (count < 0 && errno != EINTR)
        throw std::system_error(errno, std::generic_category(), "standard output");
      if (count > 0) text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

 private:
  bool kitty_;
  bool entered_ = false;
};

// ---- what is drawn
// -------------------------------------------------------------------------------

constexpr int kLinesBelow = 3;  // status, force, energy

std::string at_row(int row) { return "\033[" + std::to_string(row) + ";1H"; }

/// "force    0.52 |..:|  ", with blocks up to the height of the value; where levels were switched
/// the ground is yellow. `columns` wide.
std::string curve_line(const std::string& name, const std::vector<Column>& curve,
                       double Column::*value, const Extent& extent) {
  std::string text = name;
  bool marked = false;
  for (const Column& column : curve) {
    if (column.switched != marked) text += column.switched ? "\033[43m" : "\033[49m";
    marked = column.switched;
    const double at = extent(column.*value);
    // From one to eight eighths, U+2581 to U+2588.
    if (std::isfinite(at))
      text += {'\xe2', '\x96', static_cast<char>(0x81 + std::lround(7 * std::clamp(at, 0.0, 1.0)))};
    else
      text += ' ';
  }
  return text + "\033[49m";
}

class Display {
 public:
  Display(const Scene& scene, const TerminalOptions& options)
      : scene_(scene), options_(options), pixels_(options.mode) {}

  bool kitty() const { return pixels_.kitty(); }

  /// Takes over the terminal's size, and the camera from the next frame.
  void resize() {
    size_ = terminal_size();
    fitted_ = false;
  }

  /// The picture on the upper part of the terminal.
  std::vector<std::string> picture(const Frame& frame) {
    const int rows = std::max(1, size_.rows - kLinesBelow);
    // Symbols have eight by eight pixels each, and are twice as high as wide.
    int width = pixels_.symbols() ? 8 : size_.cell_width;
    int height = pixels_.symbols() ? 16 : size_.cell_height;
    // More pixels are not worth their time: of a large terminal the picture is enlarged, by the
    // terminal itself where it can, which is sent the fewer bytes.
    const double most = kitty() ? 3e5 : 6e5;
    const double factor =
        std::min(1.0, std::sqrt(most / (1.0 * width * height * size_.columns * rows)));
    RenderOptions how = options_.render;
    how.width = std::max(1, static_cast<int>(factor * width * size_.columns));
    how.height = std::max(1, static_cast<int>(factor * height * rows));
    if (kitty()) {
      width = std::max(1, static_cast<int>(factor * width));
      height = std::max(1, static_cast<int>(factor * height));
    }
    how.supersampling = 1;
    if (!fitted_)
      camera_ =
          fit_camera(scene_, frame, how, options_.azimuth_degrees, options_.elevation_degrees);
    fitted_ = true;
    return pixels_.encode(render(scene_, frame, camera_, how), size_.columns, rows, width, height);
  }

  std::string draw(const Frame& frame, const Traces& traces, std::uint64_t dropped) {
    std::string text = "\033[?2026h";  // what comes until ...l appears at once
    if (kitty()) text += "\033_Ga=d\033\\";
    int row = 1;
    for (const std::string& line : picture(frame)) text += at_row(row++) + line;
    row = std::max(1, size_.rows - kLinesBelow) + 1;
    const auto below = [&](const std::string& line) {
      if (row <= size_.rows) text += at_row(row++) + "\033[0m" + line + "\033[K";
    };
    below(status(frame, dropped));
    const Extent energy = energy_extent(traces);
    const int room = size_.columns - static_cast<int>(label("", 0).size());
    const auto curve = columns(traces, std::max(0, room));
    const Extent force = force_extent(traces);
    below(curve_line(label("force", force.high), curve, &Column::force, force));
    below(std::isfinite(energy.low)
              ? curve_line(label("energy", energy.high), curve, &Column::energy, energy)
              : "");
    return text + "\033[?2026l";
  }

  /// As it stands on the terminal when all is over.
  std::string last(const Frame& frame, std::uint64_t dropped) {
    std::string text;
    for (const std::string& line : picture(frame)) text += line + "\033[0m\r\n";
    return text + status(frame, dropped) + "\r\n";
  }

 private:
  /// The name of a curve, and what its highest block stands for.
  static std::string label(std::string name, double high) {
    name.resize(7, ' ');
    std::string number = three_digits(high);
    number.insert(0, number.size() < 9 ? 9 - number.size() : 0, ' ');
    return name + number + " ";
  }
  std::string status(const Frame& frame, std::uint64_t dropped) const {
    return status_text(scene_, frame, dropped).substr(0, static_cast<std::size_t>(size_.columns));
  }

  const Scene& scene_;
  const TerminalOptions& options_;
  TerminalPixels pixels_;
  Size size_ = terminal_size();
  Camera camera_;
  bool fitted_ = false;
};

}  // namespace

void run_terminal(const std::string& frames, const TerminalOptions& options) {
  if (!::isatty(STDOUT_FILENO))
    throw Error("--terminal: standard output is not a terminal; --png draws a frame into a file");
  const FileDescriptor woken(::eventfd(0, EFD_CLOEXEC));
  if (!woken) throw std::system_error(errno, std::generic_category(), "eventfd");
  wake_fd = woken.get();
  Feed feed(frames, wake);
  Display display(feed.scene(), options);
  for (const int signal : kEnding) handle(signal);
  handle(SIGTSTP);
  handle(SIGWINCH);

  Frame frame;
  Traces traces;
  Feed::State state;
  bool any = false;
  {
    Screen screen(display.kitty());
    screen.write("waiting for frames");
    feed.start();
    while (!ending_signal && !state.ended) {
      pollfd file{woken.get(), POLLIN, 0};
      std::uint64_t count = 0;
      if (::poll(&file, 1, -1) == 1) static_cast<void>(!::read(woken.get(), &count, sizeof count));
      if (stop_asked) {
        stop_asked = 0;
        screen.leave();
        ::raise(SIGSTOP);  // and goes on here
        screen.enter();
        size_changed = 1;
      }
      if (size_changed) {
        size_changed = 0;
        display.resize();
        screen.write("\033[0m\033[2J");
      }
      state = feed.update(frame, traces);
      any = any || state.fresh;
      if (any) screen.write(display.draw(frame, traces, state.dropped));
    }
  }
  if (ending_signal) die_of(ending_signal);
  if (any) {
    OutputFile output("-", /*binary=*/false);
    output.write(display.last(frame, state.dropped));
    output.commit();
  }
  feed.check();
}

}  // namespace hapgrid
