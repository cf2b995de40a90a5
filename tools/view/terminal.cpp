#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <system_error>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/base/file.hpp"
#include "libcore/base/format.hpp"
#include "libcore/base/text.hpp"
#include "libcore/scene/render.hpp"
#include "tools/common/terminal_turn.hpp"
#include "tools/view/feed.hpp"
#include "tools/view/live.hpp"
#include "tools/view/pixels.hpp"
#include "tools/view/screen.hpp"
#include "tools/view/status.hpp"

namespace hapgrid {

namespace {

constexpr int kMostSixels = 1000;  // in a row: xterm leaves a wider picture blank
constexpr int kSymbolScale = 2;    // of the legend, whose letters are the terminal's own

std::string at_row(int row) { return format("\033[{};1H", row); }

class Display {
 public:
  Display(const Scene& scene, const RenderOptions& how, const std::string& mode)
      : scene_(scene), how_(how), pixels_(mode) {}

  /// Takes over the terminal's size, and fits the camera to it at the next frame.
  void resize() {
    size_ = terminal_size();
    fitted_ = false;
  }

  /// The picture on the upper part of the terminal.
  std::vector<std::string> picture(const Frame& frame) {
    const int rows = picture_rows();
    // Symbols have eight by eight pixels each, and are twice as high as wide.
    int width = pixels_.symbols() ? 8 : size_.cell_width;
    int height = pixels_.symbols() ? 16 : size_.cell_height;
    if (!pixels_.symbols() && width * size_.columns > kMostSixels) {
      height = std::max(1, height * kMostSixels / (width * size_.columns));
      width = std::max(1, kMostSixels / size_.columns);
    }
    // More pixels are not worth their time: of a large terminal the picture is enlarged.
    const double factor =
        std::min(1.0, std::sqrt(6e5 / (1.0 * width * height * size_.columns * rows)));
    RenderOptions how = how_;
    how.width = std::max(1, static_cast<int>(factor * width * size_.columns));
    how.height = std::max(1, static_cast<int>(factor * height * rows));
    how.supersampling = 1;
    how.letters = !pixels_.symbols();
    how.letter_scale = pixels_.symbols() ? kSymbolScale : 1;
    if (!fitted_) camera_ = fit_camera(scene_, frame, how);
    fitted_ = true;
    if (pixels_.symbols()) write_legend(frame, how, rows);
    return pixels_.encode(render(scene_, frame, camera_, how), size_.columns, rows, width, height);
  }

  std::string draw(const Frame& frame) {
    std::string text = "\033[?2026h";  // what comes until ...l appears at once
    int row = 1;
    for (const std::string& line : picture(frame)) text += at_row(row++) + line;
    text += "\033[0;30;107m" + legend_ + "\033[0m";
    row = picture_rows() + 1;
    const auto below = [&](const std::string& line) {
      if (row <= size_.rows) text += at_row(row++) + "\033[0m" + line + "\033[K";
    };
    below(status(frame));
    if (!scene_.keys.empty()) below(fitting(scene_.keys));
    return text + "\033[?2026l";
  }

  /// As it stands on the terminal when all is over.
  std::string last(const Frame& frame) {
    std::string text;
    for (const std::string& line : picture(frame)) text += line + "\033[0m\r\n";
    return text + status(frame) + "\r\n";
  }

 private:
  int picture_rows() const { return std::max(1, size_.rows - (scene_.keys.empty() ? 1 : 2)); }
  /// The legend's letters in the terminal's own cells.
  void write_legend(const Frame& frame, const RenderOptions& how, int rows) {
    legend_.clear();
    for (const Label& label : hapgrid::draw(scene_, frame, camera_, how).labels) {
      const int row = static_cast<int>(label.left[1] * rows / how.height);
      const int column = static_cast<int>(label.left[0] * size_.columns / how.width);
      if (row < 0 || row >= rows || column < 0) continue;
      const int room = std::max(0, size_.columns - column);
      legend_ += format("\033[{};{}H", row + 1, column + 1) +
                 label.text.substr(0, static_cast<std::size_t>(room));
    }
  }
  std::string status(const Frame& frame) const { return fitting(status_text(scene_, frame)); }
  std::string fitting(const std::string& text) const {
    return printable_line(text, static_cast<std::size_t>(size_.columns));
  }

  const Scene& scene_;
  const RenderOptions& how_;
  TerminalPixels pixels_;
  TerminalSize size_ = terminal_size();
  Camera camera_;
  std::string legend_;  // what writes it; of symbols
  bool fitted_ = false;
};

}  // namespace

void run_terminal(const std::string& frames, const RenderOptions& how, const std::string& mode) {
  if (!::isatty(STDOUT_FILENO))
    throw Error("--terminal: standard output is not a terminal; --png draws a frame into a file");
  const FileDescriptor woken(::eventfd(0, EFD_CLOEXEC));
  if (!woken) throw std::system_error(errno, std::generic_category(), "eventfd");
  // Until there is a scene, signals do what they always do.
  Feed feed(frames, wake);
  Display display(feed.scene(), how, mode);
  watch_signals(woken.get());

  Frame frame;
  Feed::State state;
  bool any = false;
  const TerminalTurn turn(STDOUT_FILENO);
  {
    Screen screen;
    screen.write("waiting for frames");
    feed.start();
    while (!ending_signal() && !state.ended) {
      pollfd file{woken.get(), POLLIN, 0};
      std::uint64_t count = 0;
      if (::poll(&file, 1, state.more ? 0 : -1) == 1)
        static_cast<void>(!::read(woken.get(), &count, sizeof count));
      if (stop_was_asked()) {
        screen.leave();
        ::raise(SIGSTOP);  // and goes on here
        screen.enter();
        display.resize();
      }
      if (size_was_changed()) {
        display.resize();
        screen.write("\033[0m\033[2J");
      }
      state = feed.update(frame);
      any = any || state.fresh;
      if (any) screen.write(display.draw(frame));
    }
  }
  if (ending_signal()) die_of(ending_signal());
  if (any) write_text("-", display.last(frame));
  feed.check();
}

}  // namespace hapgrid
