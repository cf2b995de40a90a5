#include "libcore/grid/level_index.hpp"

#include <bit>
#include <utility>

namespace hapgrid {

namespace {

bool bit(std::span<const std::uint64_t> bits, std::uint64_t i) {
  return bits[i / 64] >> i % 64 & 1;
}

/// Whether none of the bits [begin, begin + count) is set, count at most 65; bits behind the end
/// are 0.
bool is_clear(std::span<const std::uint64_t> bits, std::uint64_t begin, std::uint64_t count) {
  for (std::uint64_t i = begin; i < begin + count;) {
    const std::uint64_t word = i / 64, shift = i % 64;
    if (word >= bits.size()) return true;
    const std::uint64_t left = begin + count - i;
    const std::uint64_t rest = bits[word] >> shift;
    if ((left < 64 - shift ? rest & ((std::uint64_t{1} << left) - 1) : rest) != 0) return false;
    i += 64 - shift;
  }
  return true;
}

}  // namespace

LevelIndex::LevelIndex(std::uint64_t points, std::uint64_t records,
                       std::span<const std::uint64_t> is_upper, std::vector<PointIndex> point)
    : count_(points), records_(static_cast<RecordIndex>(records)), point_(std::move(point)) {
  index_points(is_upper);
  if (is_whole()) index_records(is_upper);
}

void LevelIndex::index_points(std::span<const std::uint64_t> is_upper) {
  point_blocks_.reserve(count_ / kBlock + 1);
  RecordIndex r = 0;
  for (std::uint64_t first = 0; first <= count_; first += kBlock) {
    Block block{r, kPlain};
    if (is_whole() && first + kBlock <= count_ && is_clear(is_upper, r, kBlock + 1)) {
      r += kBlock;
    } else {
      block.table = static_cast<std::uint32_t>(offsets_.size() / kOffsets);
      for (std::uint64_t p = first; p < first + kBlock; ++p) {
        offsets_.push_back(static_cast<std::uint16_t>(r - block.base));
        if (p >= count_ || (!is_whole() && (r == records_ || point_[r] != p))) continue;
        for (++r; r < records_ && bit(is_upper, r);) ++r;
      }
      offsets_.push_back(static_cast<std::uint16_t>(r - block.base));
    }
    point_blocks_.push_back(block);
  }
  offsets_.shrink_to_fit();
}

void LevelIndex::index_records(std::span<const std::uint64_t> is_upper) {
  record_blocks_.reserve(is_upper.size());
  PointIndex next = 0;  // the point of the next record whose level is 0
  for (std::uint64_t first = 0; first < records_; first += kBlock) {
    const std::uint64_t upper = is_upper[first / 64];
    Block block{next - static_cast<PointIndex>(upper & 1), kPlain};
    if (upper == 0) {
      next += kBlock;
    } else {
      block.table = static_cast<std::uint32_t>(points_.size() / kBlock);
      for (std::uint64_t i = 0; i < kBlock; ++i) {
        if (!(upper >> i & 1)) ++next;
        points_.push_back(static_cast<std::uint8_t>(next - 1 - block.base));
      }
    }
    record_blocks_.push_back(block);
  }
  points_.shrink_to_fit();
}

}  // namespace hapgrid
