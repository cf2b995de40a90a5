// The frontier of a grid as work to be shared out: the unit is one conversion, so a record's 26
// directions can go to different parts.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/shard/reader.hpp"

namespace hapgrid {

/// Part K of N, 1 <= K <= N < 2^32.
struct Part {
  std::uint64_t number = 1;
  std::uint64_t of = 1;
};

/// Which conversions of a frontier are a part's. Slow conversions lie together, so the frontier is
/// cut into blocks of equally many conversions, which are dealt out in turns: block b goes to part
/// b mod N + 1. The size of a block follows from the number of conversions and N alone.
class Deal {
 public:
  Deal(std::uint64_t conversions, Part part);

  /// Conversions of the part.
  std::uint64_t conversions() const;
  /// Whether one of the conversions [begin, end) is the part's.
  bool has_any(std::uint64_t begin, std::uint64_t end) const;
  /// Of the `directions`, whose conversions are those from `first` on, the part's.
  DirectionMask own(DirectionMask directions, std::uint64_t first) const;

 private:
  static constexpr std::uint64_t kTurns = 512;

  bool is_own(std::uint64_t block) const { return block % part_.of == part_.number - 1; }

  std::uint64_t total_;
  Part part_;
  std::uint64_t block_;  // conversions in a block
};

/// A part of the frontier of a grid, record by record. Only the chunks of the part are read. Where
/// the frontier lies in many chunks, whole chunks are dealt out, so that no chunk is read by
/// several parts: the largest first, each to the part that has the fewest conversions so far.
class FrontierReader {
 public:
  /// @param grid must outlive this object.
  explicit FrontierReader(const Section& grid, Part part = {});

  /// Conversions that the part asks for.
  std::uint64_t conversions() const { return conversions_; }

  struct Record {
    PointIndex point;
    Level level;
    const double* state;
    DirectionMask todo;
  };
  /// The next record, valid until the next call; false behind the last. @throw FormatError
  bool next(Record& record);

 private:
  static constexpr std::uint64_t kManyChunks = 16;  // a part

  void deal_chunks(Part part);
  bool next_chunk();

  const Section& grid_;
  Neighbourhood neighbourhood_;
  Deal deal_;
  std::vector<bool>
      own_chunks_;  // where whole chunks are dealt out: by chunk, whether it is the part's
  std::uint64_t conversions_ = 0;
  SectionReader reader_;
  std::size_t chunk_ = 0;  // to be read next
  RecordRows rows_;
  std::size_t row_ = 0;       // to be looked at next
  std::uint64_t passed_ = 0;  // conversions before it
};

}  // namespace hapgrid
