// Writing one section of a shard: header, chunks, footer.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

#include "libcore/base/file.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

class ChunkEncoder;

/// Where the chunks of a grid end: at the multiples of the points that one of them holds, so that
/// what does not change keeps its bytes; or where they are full, for the few records that a
/// generation has here and there.
enum class Cut { kByPoints, kByRows };

/// Rows are given in order, one by one, and leave in chunks whose boundaries depend on the rows
/// alone; so the same rows give the same bytes. finish() writes the footer: without it the section
/// is truncated, and no tool takes it.
class SectionWriter {
 public:
  /// Writes to `fd`, which the caller keeps open; `name` is for messages. @param cut of a grid.
  /// @throw std::system_error
  SectionWriter(int fd, const std::string& name, const SectionHeader& header,
                Cut cut = Cut::kByPoints);
  ~SectionWriter();
  SectionWriter(SectionWriter&&) noexcept;

  /// A record of a grid. `row_numbers`: row_size() of them, the state first; `links` 26 levels.
  /// @throw std::system_error
  void record(PointIndex point, Level level, std::uint32_t generation, const double* row_numbers,
              const Level* links);
  /// A grid's records [begin, end) of `rows`. @throw std::system_error
  void records(const RecordRows& rows, std::size_t begin, std::size_t end);
  /// A record of a frontier with the directions to be expanded; `state` n doubles. @throw
  /// std::system_error
  void frontier(PointIndex point, Level level, const double* state, DirectionMask todo);
  /// What the conversions of a source record reached. `rows`: 26 x row_size() numbers, of which
  /// those of the `directions` count, one at least. @throw std::system_error
  void requests(PointIndex point, Level level, DirectionMask directions, const double* rows);

  /// A whole chunk of a grid as it is stored: no record of it is in the frontier, and no other
  /// record of its range of points is written. @throw std::system_error
  void copy(const StoredChunk& chunk);

  /// Writes what is left and the footer. @throw std::system_error
  void finish();

 private:
  class Encoder;
  /// The rows of the chunk that is being filled, row_limit_ at most. Not initialised: a small
  /// section touches little of it.
  struct Columns {
    std::unique_ptr<PointIndex[]> point;
    std::unique_ptr<Level[]> level;
    std::unique_ptr<double[]> numbers;            // row_limit_ x row_size_
    std::unique_ptr<std::uint32_t[]> generation;  // records
    std::unique_ptr<Level[]> links;               // grids
    std::unique_ptr<DirectionMask[]> directions;  // frontiers and requests
  };

  /// A chunk of a grid ends where its range of points ends.
  void enter_range(PointIndex point);
  void count_frontier(PointIndex point, std::uint32_t generation);
  /// Adds one more row and answers its number in the chunk.
  std::size_t add_row(PointIndex point, Level level, const double* numbers) {
    if (rows_ == row_limit_) flush();
    columns_.point[rows_] = point;
    columns_.level[rows_] = level;
    if (row_size_ == 1)
      columns_.numbers[rows_] = *numbers;
    else
      std::memcpy(&columns_.numbers[rows_ * row_size_], numbers, row_size_ * sizeof(double));
    return rows_++;
  }
  std::size_t message_bytes() const;
  void flush();
  RecordRows rows_so_far() const;

  SectionHeader header_;
  std::uint32_t row_size_;
  Neighbourhood neighbourhood_;
  std::unique_ptr<Encoder> encoder_;
  std::unique_ptr<ChunkEncoder> coder_;  // of a coded grid
  SectionFooter footer_;
  Columns columns_;
  std::size_t rows_ = 0;
  std::size_t requests_ = 0;    // of the rows
  std::uint32_t frontier_ = 0;  // of the rows, as the next one
  std::uint32_t conversions_ = 0;
  Cut cut_;
  std::uint64_t range_end_ = 0;  // of a grid's chunk: the first point behind its range
  std::uint32_t row_limit_;      // of a chunk; of a grid's also its points; of requests these
};

}  // namespace hapgrid
