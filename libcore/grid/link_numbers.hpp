// Which of the distinct links of a grid each record has: one number for a block of records that all
// have the same, and four bytes a record in the other blocks. Small grids have few blocks of the
// one kind: there each record has two bytes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <span>
#include <utility>

#include "libcore/grid/own_blocks.hpp"

namespace hapgrid {

class LinkNumbers {
 public:
  static constexpr std::size_t kBlock = OwnBlocks::kRecords;
  static constexpr std::uint32_t kMixed = std::uint32_t{1} << 31;

  LinkNumbers() = default;
  explicit LinkNumbers(std::size_t records)
      : block_of_(records, /*first_own=*/kMixed + 1), own_(block_of_.size() * kBlock) {}

  /// Real-time safe.
  std::uint32_t operator[](std::size_t r) const {
    if (!flat_.empty()) return flat_[r];
    const std::uint32_t block = block_of_[r / kBlock] - 1;
    return block < kMixed ? block : own_[std::size_t{block - kMixed} * kBlock + r % kBlock];
  }
  /// What records [16 b, 16 b + 16) all have; kMixed or more where they need not have the same.
  std::uint32_t of_block(std::size_t b) const { return flat_.empty() ? block_of_[b] - 1 : kMixed; }

  /// Sets those from record `first` on. Threads may do that at once for different records, all with
  /// the same mutex.
  void set(std::size_t first, std::span<const std::uint32_t> numbers, std::mutex& mutex) {
    for (std::size_t r = first, end = first + numbers.size(); r < end;) {
      const std::size_t next = std::min(end, (r / kBlock + 1) * kBlock);
      const auto piece = numbers.subspan(r - first, next - r);
      if (piece.size() == kBlock) {
        set_block(r, piece);
      } else {  // another run has the rest of the block
        const std::lock_guard lock(mutex);
        set_block(r, piece);
      }
      r = next;
    }
  }
  /// After the last set(). Where most blocks do not share a number, two bytes a record are less
  /// memory, and found faster.
  /// @param count of distinct links
  void finish(std::size_t records, std::size_t count) {
    own_.keep(block_of_.owned() * kBlock);
    if (block_of_.owned() <= block_of_.size() / 2 || count > 0x10000) return;
    LargeArray<std::uint16_t> flat(records);
    for (std::size_t r = 0; r < records; ++r) flat[r] = static_cast<std::uint16_t>((*this)[r]);
    flat_ = std::move(flat);
    block_of_ = {};
    own_ = {};
  }

 private:
  void set_block(std::size_t r, std::span<const std::uint32_t> piece) {
    const std::size_t b = r / kBlock;
    const std::uint32_t before = block_of_[b];
    if ((before == 0 || before == piece[0] + 1) && piece[0] < kMixed &&
        std::all_of(piece.begin(), piece.end(), [&](std::uint32_t n) { return n == piece[0]; })) {
      block_of_.share(b, piece[0] + 1);
      return;
    }
    std::uint32_t* const own = own_.data() + block_of_.own(b) * kBlock;
    if (before > 0 && before <= kMixed) std::fill_n(own, kBlock, before - 1);
    std::copy(piece.begin(), piece.end(), own + r % kBlock);
  }

  OwnBlocks block_of_;              // 0: not set; up to kMixed: a shared number, and 1
  LargeArray<std::uint32_t> own_;   // what no block uses takes no memory
  LargeArray<std::uint16_t> flat_;  // by record, in place of the others
};

}  // namespace hapgrid
