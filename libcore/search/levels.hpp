// The array X[x, l] of Algorithm 1 while it grows: lines 10 to 20 of the paper.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

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

  /// Adds a record that is known already; a point's records come by level. `numbers` is its row,
  /// spec.row_size() of them, the state first.
  /// @throw FormatError when its level is not the next one at its point.
  void append(PointIndex point, Level level, std::uint32_t generation, const double* numbers,
              const Level* links);

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

  /// Directions of a record that are not settled.
  DirectionMask unsettled(PointIndex point, Level level) const;

  /// Calls f(point, level, generation, row, links) for the records of block `number`, ascending.
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

  // A record is its row, links, next record of its point, generation, in one row of stride_
  // doubles: what a request touches is one or two cache lines.
  struct Block {
    std::vector<std::uint32_t> first;  // block_points, first record of each point
    std::unique_ptr<double[]> rows;    // not initialised beyond `records`
    std::uint32_t capacity = 0;
    std::uint32_t records = 0;
  };
  struct Tail {
    std::uint32_t next;
    std::uint32_t generation;
    Level links[kDirections];
  };

  Block& block(PointIndex point);
  const Block* find_block(PointIndex point) const { return blocks_[point >> block_bits_].get(); }
  double* row(Block& block, std::uint32_t r) { return &block.rows[std::size_t{r} * stride_]; }
  const double* row(const Block& block, std::uint32_t r) const {
    return &block.rows[std::size_t{r} * stride_];
  }
  Tail& tail(double* row) { return *reinterpret_cast<Tail*>(row + row_size_); }
  const Tail& tail(const double* row) const {
    return *reinterpret_cast<const Tail*>(row + row_size_);
  }
  std::uint32_t in_block(PointIndex point) const { return point & (block_points_ - 1); }
  /// The row of a record, nullptr where there is none.
  const double* find(PointIndex point, Level level) const;
  std::uint32_t add(Block& block, const double* numbers, std::uint32_t generation);
  [[noreturn]] void fail_level_limit(PointIndex target, int q, Level source_level) const;

  const GridSpec& spec_;
  const Model& model_;
  Neighbourhood neighbourhood_;
  std::uint32_t row_size_;
  std::uint32_t block_points_;
  unsigned block_bits_;
  std::size_t stride_;
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

template <class F>
void Levels::visit(std::uint64_t number, F&& f) const {
  const Block* block = blocks_[number].get();
  if (!block) return;
  for (std::uint32_t i = 0; i < block_points_; ++i) {
    Level level = 0;
    for (std::uint32_t r = block->first[i]; r != kNone;) {
      const double* here = row(*block, r);
      const Tail& t = tail(here);
      f(static_cast<PointIndex>(number * block_points_ + i), level++, t.generation, here, t.links);
      r = t.next;
    }
  }
}

}  // namespace hapgrid
