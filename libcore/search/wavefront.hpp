// One generation of conversions on its way: frontier records come in ascending order, their
// conversions are computed in any order, and the requests leave ascending by
// (target, source point, source level) - the order in which shards hold them and merges drain them
// (design section 2).
//
// The problem is sorting 26 requests a record by target. Alternatives: sort each batch and merge
// (compares and moves every state), or a heap over 26 cursors (some 5 compares a request). Chosen:
// no sorting at all. A request's target tells its source, so each target keeps one word, the set
// of directions it is reached by, and the 26 sources are looked up again in order when the target's
// turn comes. Words live in blocks of points that exist only between the first source that reaches
// them and the last, so memory follows the two slices around the wave and not the grid.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

class Wavefront {
 public:
  /// A slot is one frontier record; slots are numbered in the order of add().
  using Slot = std::uint64_t;

  explicit Wavefront(const GridSpec& spec);

  /// How many slots one batch has: conversions are computed a batch at a time.
  std::size_t batch_size() const { return batch_size_; }

  /// Adds a frontier record; (point, level) must ascend. `todo` are the directions to expand.
  void add(PointIndex point, Level level, const double* state, DirectionMask todo);
  /// The slots that were added and are not drained are [oldest(), end()).
  Slot end() const { return end_; }

  PointIndex point(Slot slot) const { return source(slot).point; }
  Level level(Slot slot) const { return source(slot).level; }
  DirectionMask todo(Slot slot) const { return source(slot).todo; }
  const double* state(Slot slot) const { return &batch(slot).state[in_batch(slot) * n_]; }
  /// Where the row that conversion q of a slot reaches is to be written: row_size() doubles.
  double* reached(Slot slot, int q) {
    return &batches_[batch_of(slot)].reached[(in_batch(slot) * kDirections + q) * row_size_];
  }

  /// Calls f(target, q, slot, row reached) for every request with target < `end`, ascending, and
  /// forgets it. All conversions of slots whose point is below end + reach must be computed.
  template <class F>
  void drain(std::uint64_t end, F&& f);

  /// The first target that a record at `point` or later can still reach.
  std::uint64_t settled_before(PointIndex point) const {
    const auto reach = static_cast<std::uint64_t>(neighbourhood_.reach());
    return point > reach ? point - reach : 0;
  }

  const Neighbourhood& neighbourhood() const { return neighbourhood_; }

 private:
  static constexpr unsigned kBlockBits = 12;
  static constexpr std::uint32_t kBlockPoints = 1u << kBlockBits;

  struct Source {
    PointIndex point;
    DirectionMask todo;
    Level level;
  };
  // Not initialised: a small frontier touches little of it.
  struct Batch {
    std::unique_ptr<Source[]> source;
    std::unique_ptr<double[]> state;    // batch_size x n
    std::unique_ptr<double[]> reached;  // batch_size x 26 x row_size
  };
  /// What is known of 2^12 consecutive points.
  struct Block {
    DirectionMask arriving[kBlockPoints];  // as targets: the directions they are reached by
    Slot first[kBlockPoints];              // as sources: their first slot
  };

  std::size_t batch_of(Slot slot) const {
    return static_cast<std::size_t>((slot - oldest_) >> batch_bits_);
  }
  std::size_t in_batch(Slot slot) const {
    return static_cast<std::size_t>(slot & (batch_size_ - 1));
  }
  const Batch& batch(Slot slot) const { return batches_[batch_of(slot)]; }
  const Source& source(Slot slot) const { return batch(slot).source[in_batch(slot)]; }
  Block& block(std::uint64_t number);
  void forget_before(std::uint64_t target);

  Neighbourhood neighbourhood_;
  std::uint64_t points_;
  std::uint32_t n_;         // of a state, which conversions start from
  std::uint32_t row_size_;  // of what they reach
  unsigned batch_bits_;
  std::size_t batch_size_;
  std::vector<Batch> batches_;
  std::vector<Batch> free_batches_;
  Slot oldest_ = 0;  // first slot of batches_.front()
  Slot end_ = 0;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<std::unique_ptr<Block>> free_blocks_;
  std::uint64_t drained_ = 0;      // all targets below are done
  std::uint64_t first_block_ = 0;  // blocks below are freed
};

template <class F>
void Wavefront::drain(std::uint64_t end, F&& f) {
  end = std::min(end, points_);
  while (drained_ < end) {
    const std::uint64_t number = drained_ >> kBlockBits;
    const std::uint64_t block_end = std::min(end, (number + 1) << kBlockBits);
    Block* here = blocks_[number].get();
    if (!here) {
      drained_ = block_end;
      continue;
    }
    for (std::uint64_t t = drained_; t < block_end; ++t) {
      DirectionMask arriving = std::exchange(here->arriving[t & (kBlockPoints - 1)], 0);
      // Descending q: ascending source point.
      while (arriving) {
        const int q = std::bit_width(arriving) - 1;
        arriving &= ~(DirectionMask{1} << q);
        const auto from =
            static_cast<PointIndex>(static_cast<std::int64_t>(t) - neighbourhood_.offset(q));
        Slot slot = blocks_[from >> kBlockBits]->first[from & (kBlockPoints - 1)];
        for (; slot < end_ && point(slot) == from; ++slot)
          if (todo(slot) >> q & 1) f(static_cast<PointIndex>(t), q, slot, reached(slot, q));
      }
    }
    drained_ = block_end;
  }
  forget_before(drained_);
}

}  // namespace hapgrid
