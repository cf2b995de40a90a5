// Passes values from one thread to another in order. Neither thread ever waits for the other.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hapgrid {

/// For one writer and one reader. push() is the writer's, peek() and pop() the reader's; all are
/// wait-free, and real-time safe.
///
/// Each end counts the values that ever went through it, and keeps the last known count of the
/// other end, so that it fetches the other's cache line only when the ring looks full or empty.
template <class T>
class SpscRing {
 public:
  /// Allocates the memory for `capacity` values, 1 or more, and touches it.
  explicit SpscRing(std::size_t capacity) : values_(capacity) {}

  std::size_t capacity() const noexcept { return values_.size(); }

  /// Returns false, and does not keep the value, when the ring is full.
  bool push(const T& value) noexcept {
    const std::uint64_t written = written_.load(std::memory_order_relaxed);
    if (written - known_read_ == values_.size()) {
      known_read_ = read_.load(std::memory_order_acquire);
      if (written - known_read_ == values_.size()) return false;
    }
    values_[write_at_] = value;
    if (++write_at_ == values_.size()) write_at_ = 0;
    written_.store(written + 1, std::memory_order_release);
    return true;
  }

  /// The oldest values that are contiguous in memory; empty when there are none.
  std::span<const T> peek() noexcept {
    const std::uint64_t written = written_.load(std::memory_order_acquire);
    const std::uint64_t count = written - read_.load(std::memory_order_relaxed);
    return {values_.data() + read_at_,
            static_cast<std::size_t>(std::min<std::uint64_t>(count, values_.size() - read_at_))};
  }
  /// Removes the first `count` values of peek().
  void pop(std::size_t count) noexcept {
    read_at_ = (read_at_ + count) % values_.size();
    read_.store(read_.load(std::memory_order_relaxed) + count, std::memory_order_release);
  }

 private:
  static constexpr std::size_t kCacheLine = 64;

  std::vector<T> values_;
  alignas(kCacheLine) std::atomic<std::uint64_t> written_{0};
  std::size_t write_at_ = 0;  // the writer's alone, as the next one
  std::uint64_t known_read_ = 0;
  alignas(kCacheLine) std::atomic<std::uint64_t> read_{0};
  std::size_t read_at_ = 0;  // the reader's alone
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
};

}  // namespace hapgrid
