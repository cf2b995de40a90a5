// The array X[x, l] of Algorithm 1 while it grows: lines 10 to 20 of the paper.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

/// Records live in blocks of consecutive points, the points of one chunk of a grid; a block can be
/// given away when nothing will touch it any more, so a merge needs only those around its wave.
/// Requests must come ascending by (target, source point, source level): that order, together with
/// the tolerance function, decides which states become levels (design section 2).
class Levels {
 public:
  /// A record that settle() stored.
  struct Stored {
    PointIndex point;
    Level level;
  };

  /// @param model judges equality. @param generation of the records that settle() stores.
  Levels(const GridSpec& spec, const Model& model);

  std::uint32_t block_points() const { return block_points_; }

  /// Adds records that are known already, [begin, end) of `rows`; a point's records come by level.
  /// @throw FormatError when a level is not the next one at its point.
  void append(const RecordRows& rows, std::size_t begin, std::size_t end);

  /// Finds or stores a state at `target` (lines 11 to 19) and sets the destination level of the
  /// source record (line 20). `numbers` is the row that was reached. The same request twice in a
  /// row counts once.
  /// @param generation that a new record gets. Answers whether a record was stored.
  /// @throw FormatError when the source is not there, is not in the frontier, or was answered with
  /// another state before; Error when the level limit is reached.
  bool settle(PointIndex target, int q, Level source_level, const double* numbers,
              std::uint32_t generation);
  /// The record that settle() stored last.
  Stored last_stored() const { return last_stored_; }

  const double* state(PointIndex point, Level level) const;

  /// Calls f(rows, begin, end) for the records of block `number`, ascending: as few runs of them as
  /// there are, one where no record was added to those that were appended.
  template <class F>
  void visit(std::uint64_t number, F&& f) const;
  /// Blocks: points / block_points(), rounded up.
  std::uint64_t blocks() const { return blocks_.size(); }
  /// Whether a block has records here.
  bool holds(std::uint64_t number) const { return blocks_[number] != nullptr; }
  /// Forgets a block's records.
  void release(std::uint64_t number);

  std::uint64_t records() const { return records_; }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  // Records in columns, in the order in which they came; so a block that is read, touched in
  // places, and written again is copied in long runs. Not initialised beyond `records`.
  struct Block {
    std::vector<std::uint32_t> first;       // block_points, first record of each point
    std::unique_ptr<std::uint32_t[]> next;  // next record of a record's point
    std::unique_ptr<PointIndex[]> point;
    std::unique_ptr<Level[]> level;
    std::unique_ptr<std::uint32_t[]> generation;
    std::unique_ptr<double[]> numbers;  // records x row_size
    std::unique_ptr<Level[]> links;     // records x 26
    std::uint32_t capacity = 0;
    std::uint32_t records = 0;
  };

  Block& block(PointIndex point);
  /// Makes room for `count` more records.
  void reserve(Block& block, std::size_t count) const;
  /// Chains the records from `from` on to those of their points.
  void chain(Block& block, std::uint32_t from) const;
  /// The records of a block, valid until one is added.
  RecordRows view(const Block& block) const;
  std::uint32_t in_block(PointIndex point) const { return point & (block_points_ - 1); }
  /// The record's number in its block, kNone where there is none.
  std::uint32_t find(const Block* block, PointIndex point, Level level) const;
  [[noreturn]] void fail_level_limit(PointIndex target, int q, Level source_level) const;

  const GridSpec& spec_;
  const Model& model_;
  Neighbourhood neighbourhood_;
  std::uint32_t row_size_;
  std::uint32_t block_points_;
  unsigned block_bits_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<std::unique_ptr<Block>> free_blocks_;
  std::uint64_t records_ = 0;
  Stored last_stored_{};
  // The last request, to tell a repeated one from a contradicting one.
  PointIndex last_target_ = 0;
  int last_q_ = -1;
  Level last_source_level_ = 0;
  std::vector<double> last_row_;
};

/// Directions of a record that are not settled.
DirectionMask unsettled(const Level* links);

template <class F>
void Levels::visit(std::uint64_t number, F&& f) const {
  const Block* block = blocks_[number].get();
  if (!block) return;
  const RecordRows rows = view(*block);
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i < block_points_; ++i) {
    for (std::uint32_t r = block->first[i]; r != kNone; r = block->next[r]) {
      if (r != end) {
        if (begin != end) f(rows, begin, end);
        begin = r;
      }
      end = r + 1;
    }
  }
  if (begin != end) f(rows, begin, end);
}

}  // namespace hapgrid
