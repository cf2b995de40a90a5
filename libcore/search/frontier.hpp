// The frontier of a grid as work to be shared out: the unit is one conversion, so a record's 26
// directions can go to different parts.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/shard/merged_rows.hpp"

namespace hapgrid {

/// Part K of N, 1 <= K <= N: an N-th of the conversions, in their order.
struct Part {
  std::uint64_t number = 1;
  std::uint64_t of = 1;
};

/// Conversions [begin, end), counted through a frontier in its order; what is behind the frontier's
/// last one does not count.
struct ConversionRange {
  std::uint64_t begin = 0;
  std::uint64_t end = ~std::uint64_t{0};
};

/// The frontier of a grid or of frontier shards, record by record, cut to a part.
class FrontierReader {
 public:
  /// @param sections grids or frontiers of one generation; must outlive this object.
  /// @throw FormatError when there are requests among them.
  FrontierReader(const std::vector<Section>& sections, ConversionRange range);
  explicit FrontierReader(const std::vector<Section>& sections, Part part = {});

  /// Conversions that the part asks for.
  std::uint64_t conversions() const { return end_ - begin_; }

  struct Record {
    PointIndex point;
    Level level;
    const double* state;
    DirectionMask todo;
  };
  /// The next record, valid until the next call; false behind the last.
  /// @throw FormatError when one record comes with two different states.
  bool next(Record& record);

 private:
  bool is_before_part(const ChunkInfo& chunk, const Record* in_hand) const;
  bool next_row(Record& record, const Record* in_hand);
  void read_rest();

  Neighbourhood neighbourhood_;
  std::uint32_t n_;
  std::uint32_t generation_;
  MergedRows<RecordRows> rows_;
  Run<RecordRows> run_;
  StoredChunk passed_over_;
  std::uint64_t begin_ = 0;  // the part's conversions, counted through the frontier
  std::uint64_t end_ = 0;
  std::uint64_t passed_ = 0;
  bool others_follow_ = false;  // parts behind this one
  bool waiting_ = false;        // next_ holds a row that was read ahead
  Record next_{};
  std::vector<double> state_;
  std::vector<double> next_state_;
};

}  // namespace hapgrid
