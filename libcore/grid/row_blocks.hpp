// The rows of a grid's records, in blocks of 16. Where nothing pushes a model many rows are the
// same: blocks that have nothing but the row that most records have share one block.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <span>

#include "libcore/grid/own_blocks.hpp"

namespace hapgrid {

class RowBlocks {
 public:
  RowBlocks() = default;
  RowBlocks(std::size_t records, std::size_t width)
      : width_(width),
        block_of_(records, /*first_own=*/1),
        rows_((block_of_.size() + 1) * kBlock * width) {}

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
      const auto piece = rows.subspan((r - first) * width_, (next - r) * width_);
      if (std::memcmp(piece.data(), rows_.data(), piece.size_bytes()) != 0) {
        if (next - r == kBlock) {
          std::copy(piece.begin(), piece.end(), own_block(r / kBlock));
        } else {  // another run has the rest of the block
          const std::lock_guard lock(mutex);
          const bool is_first = !block_of_.is_own(r / kBlock);
          double* const own = own_block(r / kBlock);
          if (is_first) std::copy_n(rows_.data(), kBlock * width_, own);
          std::copy(piece.begin(), piece.end(), own + r % kBlock * width_);
        }
      }
      r = next;
    }
  }
  /// After the last set().
  void finish() { rows_.keep((1 + block_of_.owned()) * kBlock * width_); }

 private:
  static constexpr std::size_t kBlock = OwnBlocks::kRecords;

  double* own_block(std::size_t b) {
    return rows_.data() + (1 + block_of_.own(b)) * kBlock * width_;
  }

  std::size_t width_ = 0;
  OwnBlocks block_of_;
  LargeArray<double> rows_;  // the shared block first; what no block uses takes no memory
};

}  // namespace hapgrid
