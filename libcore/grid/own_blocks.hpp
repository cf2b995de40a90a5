// Columns of a grid in blocks of 16 records: most blocks hold nothing but what others hold, too,
// and the few that do not have memory of their own.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "libcore/base/large_array.hpp"

namespace hapgrid {

/// A word for each block: what its records share, or, from the first own number on, which memory of
/// its own it has. Threads may change different words at once.
class OwnBlocks {
 public:
  static constexpr std::size_t kRecords = 16;  ///< of a block

  OwnBlocks() = default;
  /// The word of each block is 0 at first. @param first_own above 0
  OwnBlocks(std::size_t records, std::uint32_t first_own)
      : first_own_(first_own), next_(first_own), words_(records / kRecords + 1) {}

  /// Real-time safe.
  std::uint32_t operator[](std::size_t block) const { return words_[block]; }
  std::size_t size() const { return words_.size(); }
  /// How many have their own memory.
  std::size_t owned() const { return next_ - first_own_; }
  bool is_own(std::size_t block) const { return words_[block] >= first_own_; }

  void share(std::size_t block, std::uint32_t word) { words_[block] = word; }
  /// Which memory of its own a block has; it gets some if it has none.
  std::size_t own(std::size_t block) {
    if (!is_own(block))
      words_[block] = std::atomic_ref(next_).fetch_add(1, std::memory_order_relaxed);
    return words_[block] - first_own_;
  }

 private:
  std::uint32_t first_own_ = 0, next_ = 0;
  LargeArray<std::uint32_t> words_;
};

}  // namespace hapgrid
