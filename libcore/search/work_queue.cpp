#include "libcore/search/work_queue.hpp"

#include <algorithm>

#include "libcore/base/format.hpp"

namespace hapgrid {

WorkQueue::WorkQueue(std::uint64_t items, std::size_t models, std::uint64_t slice,
                     const Progress& progress)
    : progress_(progress),
      slice_(slice),
      threads_(static_cast<std::size_t>(std::min<std::uint64_t>(models, items))),
      left_{0, items} {}

bool WorkQueue::refill(Slice& mine, bool idle) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t left = left_.end - left_.next;
  // The last items are for models that have nothing to do, not for a second place in a queue.
  if (left == 0 || (!idle && left < threads_)) return false;
  mine.next = left_.next;
  mine.end = left_.next += std::min(slice_, left);
  return true;
}

void WorkQueue::fail(std::uint64_t item, std::string_view why) {
  const std::lock_guard lock(mutex_);
  if (item >= failed_) return;
  failed_ = item;
  why_ = why;
}

void WorkQueue::stop() {
  const std::lock_guard lock(mutex_);
  left_.next = left_.end;
}

void WorkQueue::require_success(
    const std::function<std::string(std::uint64_t item)>& describe) const {
  if (progress_.stopped()) throw Stopped();
  if (failed_ != kNone) throw ModelError(format("{}: {}", describe(failed_), why_));
}

}  // namespace hapgrid
