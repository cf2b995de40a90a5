// The array X[x, l] of Algorithm 1 while it grows: lines 10 to 20 of the paper.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "libcore/base/error.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// A point has as many levels as the grid allows, and one more was reached.
class LevelLimit : public Error {
 public:
  using Error::Error;
};

/// The records of a whole grid, in columns, in the order in which they came: so a grid that is
/// read, touched in places, and written again is copied in long runs. The records of a point are a
/// chain. Requests must come ascending by (source point, source level): the order in which they
/// reach each target decides, together with the tolerance function, which states become levels
/// (design section 2).
class Levels {
 public:
  /// Reads the records of a grid. @param model judges equality.
  /// @throw FormatError when the grid is damaged, or has far too few records for its box;
  /// std::system_error
  Levels(const Section& grid, const Model& model);

  RecordIndex records() const { return static_cast<RecordIndex>(columns_.size()); }
  /// The record of a level; Grid::kNoRecord when there is none.
  RecordIndex find(PointIndex point, Level level) const;
  PointIndex point(RecordIndex r) const { return columns_.point[r]; }
  Level level(RecordIndex r) const { return columns_.level[r]; }
  std::uint32_t generation(RecordIndex r) const { return columns_.generation[r]; }
  /// Of the record, until settle() stores another one.
  const double* state(RecordIndex r) const { return &columns_.rows[std::size_t{r} * row_size_]; }

  /// For each of the `directions`, ascending: finds or stores the state that the conversion from
  /// record `source` reached (lines 11 to 19), and sets the link there (line 20). `row(q)` is the
  /// row that was reached in direction q; states with the same bits are equal without asking the
  /// model. New records, of generation `generation`, get the next numbers.
  /// @throw FormatError when a link is settled already; LevelLimit; ModelError.
  template <class Row>
  void settle(RecordIndex source, DirectionMask directions, std::uint32_t generation, Row&& row);

  /// Refuses a generation of which conversions are not settled yet. @throw FormatError
  void require_settled(std::uint32_t generation) const;
  /// Writes all records, and finishes the section. @throw std::system_error
  void write(SectionWriter& out) const;

 private:
  static constexpr RecordIndex kNone = Grid::kNoRecord;

  /// @throw FormatError when a level is not the next one at its point.
  void append(const Chunk& rows);
  /// Calls f(r) for each record, ascending by (point, level).
  template <class F>
  void for_each(F&& f) const {
    for (const RecordIndex first : first_)
      for (RecordIndex r = first; r != kNone; r = next_[r]) f(r);
  }
  /// Any conversion but the most frequent.
  void settle_other(RecordIndex source, int q, PointIndex target, const double* numbers,
                    std::uint32_t generation);
  /// Whether two states are the same, bit by bit.
  bool has_bits(const double* a, const double* b) const {
    return std::bit_cast<std::uint64_t>(a[0]) == std::bit_cast<std::uint64_t>(b[0]) &&
           (state_size_ == 1 || std::memcmp(a, b, state_size_ * sizeof(double)) == 0);
  }
  Level& link(RecordIndex r, int q) {
    return columns_.links[std::size_t{r} * kDirections + static_cast<unsigned>(q)];
  }
  std::string record_text(RecordIndex r) const;
  [[noreturn]] void fail_level_limit(PointIndex target, RecordIndex source) const;

  GridSpec spec_;
  const Model& model_;
  Neighbourhood neighbourhood_;
  std::uint32_t state_size_;
  std::uint32_t row_size_;
  RecordColumns columns_;
  std::vector<RecordIndex> first_;  // points: the record of level 0
  std::vector<RecordIndex> next_;   // records: that of the next level
};

template <class Row>
void Levels::settle(RecordIndex source, DirectionMask directions, std::uint32_t generation,
                    Row&& row) {
  const PointIndex point = columns_.point[source];
  for (; directions; directions &= directions - 1) {
    const int q = std::countr_zero(directions);
    const double* const numbers = row(q);
    const auto target = static_cast<PointIndex>(point + neighbourhood_.offset(q));
    // Most conversions reach the very state that is known there as the first.
    const RecordIndex first = first_[target];
    if (first != kNone && link(source, q) == kUnsettled && has_bits(state(first), numbers))
      link(source, q) = 0;
    else
      settle_other(source, q, target, numbers, generation);
  }
}

}  // namespace hapgrid
