// The array X[x, l] of Algorithm 1 while it grows: lines 10 to 20 of the paper.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// A point has as many levels as the grid allows, and one more was reached.
class LevelLimit : public Error {
 public:
  using Error::Error;
};

/// Records live in blocks of consecutive points, the points of one chunk of a grid. A block is
/// loaded when it is first touched, and can be given away when nothing will touch it any more, so a
/// merge needs only those around its wave. Requests must come ascending by (source point, source
/// level): the order in which they reach each target decides, together with the tolerance function,
/// which states become levels (design section 2).
class Levels {
  struct Block;

 public:
  /// A record that settle() stored: its point and its level.
  using Stored = std::pair<PointIndex, Level>;

  /// Where a record is, until its block is released.
  class RecordHandle {
   public:
    explicit operator bool() const { return block_ != nullptr; }

   private:
    friend class Levels;
    Block* block_ = nullptr;
    std::uint32_t record_ = 0;
  };

  /// Appends what is known of a block.
  using Load = std::function<void(std::uint64_t block)>;

  /// @param model judges equality. @param load is called when a block is touched that is not there.
  Levels(const GridSpec& spec, const Model& model, Load load = nullptr);

  std::uint32_t block_points() const { return block_points_; }

  /// Adds records that are known already; a point's records come by level.
  /// @throw FormatError when a level is not the next one at its point.
  void append(const RecordRows& rows);

  /// Loads a block that is not there.
  void touch(std::uint64_t number);
  bool is_loaded(std::uint64_t number) const { return blocks_[number] != nullptr; }

  /// Where the record is; an empty handle when there is no such record.
  RecordHandle find(PointIndex point, Level level);
  std::uint32_t generation(RecordHandle handle) const;
  const double* state(RecordHandle handle) const;

  /// For each of the `directions`, ascending: finds or stores the state that the conversion from
  /// `source` reached (lines 11 to 19), and sets the link there (line 20). `row(q)` is the row that
  /// was reached in direction q; states with the same bits are equal without asking the model.
  /// Calls stored(Stored) for each record that this stores, of generation `generation`.
  /// @throw FormatError when a link is settled already; LevelLimit.
  template <class Row, class F>
  void settle(RecordHandle source, DirectionMask directions, std::uint32_t generation, Row&& row,
              F&& stored);

  /// Calls f(rows, begin, end) for the records of block `number`, ascending, in as few runs as
  /// possible: in one when no record was added after append().
  template <class F>
  void visit(std::uint64_t number, F&& f) const;
  /// Writes all records, and finishes the section. @throw std::system_error
  void write(SectionWriter& out) const;
  /// Blocks: points / block_points(), rounded up.
  std::uint64_t blocks() const { return blocks_.size(); }
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

  Block& block(PointIndex point) {
    touch(point >> block_bits_);
    return *blocks_[point >> block_bits_];
  }
  /// Makes room for `count` more records.
  void reserve(Block& block, std::size_t count) const;
  /// Chains the records from `from` on to those of their points.
  void chain(Block& block, std::uint32_t from) const;
  /// The records of a block, valid until one is added.
  RecordRows view(const Block& block) const;
  std::uint32_t in_block(PointIndex point) const { return point & (block_points_ - 1); }
  /// Any conversion but the most frequent. Answers whether a record was stored: last_stored_.
  bool settle_other(RecordHandle source, int q, PointIndex target, const double* numbers,
                    std::uint32_t generation);
  /// Whether two states are the same, bit by bit.
  bool has_bits(const double* a, const double* b) const {
    return std::bit_cast<std::uint64_t>(a[0]) == std::bit_cast<std::uint64_t>(b[0]) &&
           (state_size_ == 1 || std::memcmp(a, b, state_size_ * sizeof(double)) == 0);
  }
  /// For messages: the source and its direction.
  std::string source_text(RecordHandle source, int q) const;
  [[noreturn]] void fail_level_limit(PointIndex target, RecordHandle source) const;

  const GridSpec& spec_;
  const Model& model_;
  Load load_;
  Neighbourhood neighbourhood_;
  std::uint32_t state_size_;
  std::uint32_t row_size_;
  std::uint32_t block_points_;
  unsigned block_bits_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<std::unique_ptr<Block>> free_blocks_;
  std::uint64_t records_ = 0;
  Stored last_stored_{};
};

template <class Row, class F>
void Levels::settle(RecordHandle source, DirectionMask directions, std::uint32_t generation,
                    Row&& row, F&& stored) {
  const PointIndex point = source.block_->point[source.record_];
  const auto links_of_source = [&] {
    return &source.block_->links[std::size_t{source.record_} * kDirections];
  };
  Level* links = links_of_source();
  for (; directions; directions &= directions - 1) {
    const int q = std::countr_zero(directions);
    const double* const numbers = row(q);
    const auto target = static_cast<PointIndex>(point + neighbourhood_.offset(q));
    // Most conversions reach the very state that is known there as the first.
    const Block* const here = blocks_[target >> block_bits_].get();
    if (here && links[q] == kUnsettled) {
      const std::uint32_t r = here->first[in_block(target)];
      if (r != kNone && has_bits(&here->numbers[std::size_t{r} * row_size_], numbers)) {
        links[q] = 0;
        continue;
      }
    }
    if (!settle_other(source, q, target, numbers, generation)) continue;
    links = links_of_source();  // making room for a record may move those of its block
    stored(last_stored_);
  }
}

template <class F>
void Levels::visit(std::uint64_t number, F&& f) const {
  const Block* block = blocks_[number].get();
  if (!block) return;
  const RecordRows rows = view(*block);
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  for (const std::uint32_t first : block->first) {
    for (std::uint32_t r = first; r != kNone; r = block->next[r]) {
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
