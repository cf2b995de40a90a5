// The expand filter: C in 26 directions for each frontier record (procedure expand_state).
#pragma once

#include <cstdint>

#include "libcore/search/converter.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

// The frontier of a grid as work to be shared out: the unit is one conversion, so a record's 26
// directions can go to different parts.

/// Part K of N, 1 <= K <= N < 2^32.
struct Part {
  std::uint64_t number = 1;
  std::uint64_t of = 1;
};

/// Which items of a round belong to a part. The items are the conversions of a frontier, or one-way
/// links. Slow conversions lie together, so the items are cut into blocks of equal size, which are
/// dealt out in turns: block b goes to part b mod N + 1. The size of a block follows from the
/// number of items and N alone. There are many turns, so that all parts take about as long; and the
/// blocks of a large frontier are long, so that few parts read the same chunk of the grid.
class Partition {
 public:
  Partition(std::uint64_t items, Part part);

  /// Items of the part.
  std::uint64_t size() const;
  /// Whether one of the items [begin, end) is the part's.
  bool has_any(std::uint64_t begin, std::uint64_t end) const;
  /// Of the `directions`, whose items are those from `first` on, the part's.
  DirectionMask mine(DirectionMask directions, std::uint64_t first) const;

 private:
  static constexpr std::uint64_t kTurns = 512;
  static constexpr std::uint64_t kLeastTurns = 32;
  static constexpr std::uint64_t kLongBlock = 1024;  // items; a chunk has some thousand

  std::uint64_t total_;
  Part part_;
  std::uint64_t block_;  // items in a block
};

/// A part of the frontier of a grid, record by record. Only chunks with conversions of the part are
/// read, and one of them is in memory at a time.
class FrontierReader {
 public:
  /// @param grid must outlive this object.
  explicit FrontierReader(const Section& grid, Part part = {});

  /// Conversions that the part asks for.
  std::uint64_t conversions() const { return partition_.size(); }

  /// The next record, valid until the next call; false behind the last. @throw FormatError
  bool next(FrontierRecord& record);

 private:
  bool next_chunk();

  const Section& grid_;
  Neighbourhood neighbourhood_;
  Partition partition_;
  SectionReader reader_;
  std::size_t chunk_ = 0;  // to be read next
  RecordRows rows_;
  std::size_t row_ = 0;       // to be looked at next
  std::uint64_t passed_ = 0;  // conversions before it
};

/// Evaluates every conversion of the records that next(FrontierRecord&) gives until it answers
/// false, and gives what was reached to out(record, rows), record by record in the same order:
/// `rows` has room for 26 rows, of which those of the directions are set. Memory: one batch.
/// @throw ModelError; what `next` and `out` throw
template <class Next, class Sink>
void expand(Next&& next, Converter& converter, const GridSpec& spec, Sink&& out) {
  Batch batch(spec);
  FrontierRecord record;
  for (bool more = true; more;) {
    while (!batch.is_full() && (more = next(record))) batch.add(record);
    converter.convert(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) out(batch.record(i), batch.reached(i));
    batch.clear();
  }
}

}  // namespace hapgrid
