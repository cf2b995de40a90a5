// The newest value from one thread to another, neither ever waiting for the other.
//
// Three slots: one that the writer fills, one that the reader looks at, and the newest finished one
// between them, which either side takes in exchange for its own. Alternatives: a lock (the fast
// thread could wait for the slow one), a sequence lock (its copy is a data race in C++, and a
// reader may have to try again forever).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace hapgrid {

/// For one writer and one reader. back() and publish() are the writer's, update() and front() the
/// reader's; all are wait-free and real-time safe.
template <class T>
class TripleBuffer {
 public:
  /// Each slot starts as a copy of `initial`: storage that is in it needs no allocation later.
  explicit TripleBuffer(const T& initial) : slots_{initial, initial, initial} {}

  /// The slot to fill; it holds some older value.
  T& back() noexcept { return slots_[back_]; }
  /// Makes back() the newest value.
  void publish() noexcept {
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & ~kFresh;
  }

  /// Brings the newest value to front(); false when there is none since the last call.
  bool update() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & ~kFresh;
    return true;
  }
  const T& front() const noexcept { return slots_[front_]; }

 private:
  static constexpr std::uint32_t kFresh = 4;

  std::array<T, 3> slots_;
  std::uint32_t back_ = 0;
  std::atomic<std::uint32_t> middle_{1};  // an index, and kFresh when the reader has not seen it
  std::uint32_t front_ = 2;
  static_assert(std::atomic<std::uint32_t>::is_always_lock_free);
};

}  // namespace hapgrid
