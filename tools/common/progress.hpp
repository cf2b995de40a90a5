// What long work tells while it goes on, and what it reports when it is done.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace hapgrid {

/// A line on standard error while this object lives: in a terminal one that is written again
/// several times a second and cut to the terminal's width, elsewhere a new one every minute.
class ProgressLine {
 public:
  /// `text` makes the line from the seconds since the start; it is called from another thread.
  explicit ProgressLine(std::function<std::string(double seconds)> text);
  /// Takes the line away again.
  ~ProgressLine();

 private:
  void show();

  std::function<std::string(double)> text_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::jthread thread_;
};

/// What ProgressLine does, until over() says after a pause that the work is done.
void write_progress(std::FILE* out, const std::function<std::string()>& text,
                    const std::function<bool(std::chrono::milliseconds pause)>& over);

/// What a line of progress begins with, as a narrow terminal cuts its end: per cent and time left.
/// part: that is done, in [0, 1]; rate: parts a second, 0 where it is not known.
std::string part_done(double part, double rate);

/// 1234567 as "1.23 M".
std::string short_number(double value);

/// The cost of one run, appended as one JSON line to the file of --cost: what must not enter a
/// shard (design section 2).
struct RunCost {
  std::string tool;
  std::uint32_t generation = 0;
  std::uint64_t conversions = 0;
  std::uint64_t part = 1;
  std::uint64_t parts = 1;
  std::string failed;  ///< "levels" or "model" where the model ended the work; or empty
};

/// Adds the wall and CPU seconds of this process and of the model processes that have ended.
/// @throw std::system_error
void append_cost(const std::string& file, const RunCost& cost);

/// Opens at least `files` files at once where the system allows it.
void allow_open_files(std::size_t files);

}  // namespace hapgrid
