// The rows of a grid's records, in blocks of 16. Where nothing pushes a model many rows are the
// same: blocks that have nothing but the row that most records have share one block.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <span>

#include "libcore/base/large_array.hpp"

namespace hapgrid {

class RowBlocks {
 public:
  RowBlocks() = default;
  RowBlocks(std::size_t records, std::size_t width)
      : width_(width),
        block_of_(records / kBlock + 1),
        rows_((records / kBlock + 2) * kBlock * width) {
    std::fill_n(block_of_.data(), block_of_.size(), kShared);
  }

  /// Real-time safe.
  const double* operator[](std::size_t r) const {
    return rows_.data() + (std::size_t{block_of_[r / kBlock]} * kBlock + r % kBlock) * width_;
  }

  /// Says what most records have, before the first set().
  void share(std::span<const double> row) {
    for (std::size_t i = 0; i < kBlock; ++i)
      std::copy(row.begin(), row.end(), rows_.data() + i * width_);
  }
  /// Sets the rows from record `first` on. Threads may do that at once for different records, all
  /// with the same mutex.
  void set(std::size_t first, std::span<const double> rows, std::mutex& mutex) {
    const std::size_t end = first + rows.size() / width_;
    for (std::size_t r = first; r < end;) {
      const std::size_t next = std::min(end, (r / kBlock + 1) * kBlock);
      const double* const from = rows.data() + (r - first) * width_;
      const std::size_t bytes = (next - r) * width_ * sizeof(double);
      // A block that two runs have in part is not shared: neither knows the other's rows.
      if (next - r < kBlock || std::memcmp(from, rows_.data(), bytes) != 0)
        std::memcpy(rows_.data() + (own_block(r / kBlock, mutex) * kBlock + r % kBlock) * width_,
                    from, bytes);
      r = next;
    }
  }

 private:
  static constexpr std::size_t kBlock = 16;
  static constexpr std::uint32_t kShared = 0;

  /// The block of records [16 b, 16 b + 16), which gets one if it has none.
  std::size_t own_block(std::size_t b, std::mutex& mutex) {
    const std::lock_guard lock(mutex);
    if (block_of_[b] == kShared) block_of_[b] = ++used_;
    return block_of_[b];
  }

  std::size_t width_ = 0;
  LargeArray<std::uint32_t> block_of_;
  std::uint32_t used_ = 0;   // blocks besides the shared one, which is the first
  LargeArray<double> rows_;  // what no block uses takes no memory
};

}  // namespace hapgrid
