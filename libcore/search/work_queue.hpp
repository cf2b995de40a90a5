// Work that is shared out among models, each in a thread of its own.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "libcore/search/progress.hpp"

namespace hapgrid {

/// Hands out the numbers [0, items) in ascending order, and remembers the first item that failed.
/// Which one that is does not depend on the threads: no item behind a failed one is handed out, and
/// all items before it are.
class WorkQueue {
 public:
  /// Items [next, end) that one thread has taken and not begun yet.
  struct Slice {
    std::uint64_t next = 0;
    std::uint64_t end = 0;
    bool is_empty() const { return next == end; }
  };

  /// @param slice items that a thread takes at a time, at least 1
  WorkQueue(std::uint64_t items, std::size_t models, std::uint64_t slice, const Progress& progress);

  /// How many of the models have something to do.
  std::size_t threads() const { return threads_; }

  /// The next item of `mine`, which is filled again when it is empty. False when the work is over,
  /// or when the last items are kept for models that are idle.
  bool next(Slice& mine, bool idle, std::uint64_t& item) {
    if (progress_.stopped() || (mine.is_empty() && !refill(mine, idle))) return false;
    if (mine.next > failed_.load(std::memory_order_relaxed)) return false;
    item = mine.next++;
    return true;
  }

  void fail(std::uint64_t item, std::string_view why);
  /// Hands out nothing more.
  void stop();
  /// @param describe says what an item is
  /// @throw Stopped; ModelError for the first item that failed
  void require_success(const std::function<std::string(std::uint64_t item)>& describe) const;

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};

  bool refill(Slice& mine, bool idle);

  const Progress& progress_;
  std::uint64_t slice_;
  std::size_t threads_;
  std::mutex mutex_;
  Slice left_;
  std::atomic<std::uint64_t> failed_{kNone};
  std::string why_;
};

}  // namespace hapgrid
