// The terminal on standard output: its size, its alternate screen, and its signals.
#pragma once

#include <string_view>

namespace hapgrid {

/// Columns, rows, and a cell's size in pixels, which many terminals do not report.
struct TerminalSize {
  int columns = 80;
  int rows = 24;
  int cell_width = 8;
  int cell_height = 16;
};

TerminalSize terminal_size();

/// Handles the signals that end or stop a program, and the one for a new size, from now on: they
/// are kept for the functions below, and `eventfd` is written. Ignored signals stay ignored
/// (nohup).
void watch_signals(int eventfd);
/// Writes to that eventfd, from any thread.
void wake();
/// The signal that asks the process to end, or 0.
int ending_signal();
/// Whether the process was asked to stop (^Z), or the size changed, since the last call.
bool stop_was_asked();
bool size_was_changed();
/// Ends the process as the signal would have.
void die_of(int signal);

/// The terminal's alternate screen, with the cursor hidden.
class Screen {
 public:
  Screen() { enter(); }
  ~Screen() { leave(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// @throw std::system_error
  void enter();
  /// Leaves the screen, even after half an escape sequence.
  void leave() noexcept;
  /// Writes text; stops early when a signal asks the process to end.
  /// @throw std::system_error
  void write(std::string_view text);

 private:
  bool entered_ = false;
};

}  // namespace hapgrid
