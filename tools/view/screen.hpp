// The terminal that standard output is: its size, its other screen, and the signals that concern
// it.
#pragma once

#include <string_view>

namespace hapgrid {

/// Columns, rows, and a cell's size in pixels, which many terminals do not tell.
struct TerminalSize {
  int columns = 80;
  int rows = 24;
  int cell_width = 8;
  int cell_height = 16;
};

TerminalSize terminal_size();

/// From now on signals that end or stop a program, or tell of another size, are kept for the
/// functions below, and `eventfd` is written to; but for those that are ignored, as nohup wants it.
void watch_signals(int eventfd);
/// Writes to that eventfd; also for other threads.
void wake();
/// The signal that wants the process to end, or 0.
int ending_signal();
/// Whether since the last call the process was asked to stop (^Z), or the size changed.
bool take_stop();
bool take_resize();
/// Ends the process as the signal would have.
void die_of(int signal);

/// The other screen of the terminal, without a cursor, while it is in use.
class Screen {
 public:
  /// @param images of kitty's protocol are on it, and go with it.
  explicit Screen(bool images) : images_(images) { enter(); }
  ~Screen() { leave(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// @throw std::system_error
  void enter();
  /// Also from the middle of a sequence that was not written to its end.
  void leave() noexcept;
  /// The rest is left out once a signal wants the process to end.
  /// @throw std::system_error
  void write(std::string_view text);

 private:
  bool images_;
  bool entered_ = false;
};

}  // namespace hapgrid
