// The expand filter: C in 26 directions for each frontier record (procedure expand_state).
#pragma once

#include <cstdint>

#include "libcore/search/converter.hpp"
#include "libcore/shard/reader.hpp"

namespace hapgrid {

/// Part K of N, 1 <= K <= N < 2^32, of the conversions of a frontier, so that a record's 26
/// directions can go to different parts. Slow conversions lie together, so they are cut into blocks
/// of equal size, which are dealt out in turns: block b goes to part b mod N + 1. The size of a
/// block follows from how many conversions there are in all and N alone. There are many turns, so
/// that all parts take about as long; and the blocks of a large frontier are long, so that few
/// parts read the same chunk of the grid.
struct Part {
  std::uint64_t number = 1;
  std::uint64_t of = 1;

  /// Of `all` conversions, how many are the part's.
  std::uint64_t size(std::uint64_t all) const;
  /// Whether one of the conversions [begin, end) is the part's.
  bool has_any(std::uint64_t all, std::uint64_t begin, std::uint64_t end) const;
  /// Of the `directions`, whose conversions are those from `first` on, the part's.
  DirectionMask mine(std::uint64_t all, DirectionMask directions, std::uint64_t first) const;

 private:
  std::uint64_t block(std::uint64_t all) const;
};

/// A part of the frontier of a grid, record by record. Only chunks with conversions of the part are
/// read, and one of them is in memory at a time.
class FrontierReader {
 public:
  /// @param grid must outlive this object.
  explicit FrontierReader(const Section& grid, Part part = {});

  /// Conversions that the part asks for.
  std::uint64_t conversions() const { return part_.size(all_); }

  /// The next record, valid until the next call; false behind the last. @throw FormatError
  bool next(FrontierRecord& record);

 private:
  bool next_chunk();

  const Section& grid_;
  Neighbourhood neighbourhood_;
  Part part_;
  std::uint64_t all_;  // conversions of the frontier
  SectionReader reader_;
  std::size_t chunk_ = 0;  // to be read next
  Chunk rows_;
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
