// Which records are a point's, and which point a record's is.
//
// Where each point has one level, both are the same number but for an offset. So for 64 points, or
// 64 records, one offset is kept, and a table only where some of these points have another number
// of levels than one: together half a byte a record in grids where most points have one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/grid/box.hpp"

namespace hapgrid {

/// The position of a record in a Grid; records ascend by (point, level).
using RecordIndex = std::uint32_t;

class LevelIndex {
 public:
  LevelIndex() = default;
  /// @param is_upper by record, 64 in a word: whether its level is above 0. Bits behind the last
  /// record are 0.
  /// @param point by record, ascending; empty where each of `points` has a record
  LevelIndex(std::uint64_t points, std::uint64_t records, std::span<const std::uint64_t> is_upper,
             std::vector<PointIndex> point);

  RecordIndex records() const { return records_; }
  /// Also for p = the number of points. Real-time safe, as all that follow.
  RecordIndex first(std::uint64_t p) const {
    const Block block = point_blocks_[p / kBlock];
    const std::uint64_t i = p % kBlock;
    return block.base + (block.table == kPlain ? static_cast<RecordIndex>(i)
                                               : offsets_[std::size_t{block.table} * kOffsets + i]);
  }
  RecordIndex levels(PointIndex p) const {
    const Block block = point_blocks_[p / kBlock];
    if (block.table == kPlain) return 1;
    const std::uint16_t* const offset = &offsets_[std::size_t{block.table} * kOffsets + p % kBlock];
    return static_cast<RecordIndex>(offset[1] - offset[0]);
  }
  PointIndex point(RecordIndex r) const {
    if (!point_.empty()) return point_[r];
    const Block block = record_blocks_[r / kBlock];
    return block.base + (block.table == kPlain
                             ? r % kBlock
                             : points_[std::size_t{block.table} * kBlock + r % kBlock]);
  }
  /// Whether each of the 64 points from 64 b on has one level; false for fewer than 64.
  bool is_single(std::uint64_t b) const {
    return point_blocks_[b].table == kPlain && (b + 1) * kBlock <= count_;
  }

  static constexpr std::uint64_t kBlock = 64;

 private:
  static constexpr std::size_t kOffsets = kBlock + 1;
  static constexpr std::uint32_t kPlain = ~std::uint32_t{0};
  struct Block {
    std::uint32_t base;   // what the first of 64 has
    std::uint32_t table;  // with the differences from this; kPlain: they are 0, 1, 2, ...
  };

  /// Whether each point has a record.
  bool is_whole() const { return point_.empty() && records_ > 0; }
  void index_points(std::span<const std::uint64_t> is_upper);
  void index_records(std::span<const std::uint64_t> is_upper);

  std::uint64_t count_ = 0;  // of points
  RecordIndex records_ = 0;
  std::vector<Block> point_blocks_, record_blocks_;
  std::vector<std::uint16_t> offsets_;  // of records: a point has 254 at most
  std::vector<std::uint8_t> points_;
  std::vector<PointIndex> point_;  // by record, where some points have none
};

}  // namespace hapgrid
