// Writing one section of a shard: header, chunks, footer.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "libcore/shard/section.hpp"

namespace hapgrid {

/// How the chunks of a grid are stored: kFast, to be read and written fast; kSmall, of a finished
/// grid, in large chunks at a high zstd level.
enum class Packing { kFast, kSmall };

/// Rows are given in order, one by one, and leave in chunks whose boundaries depend on the rows
/// alone; so the same rows give the same bytes. finish() writes the footer: without it the section
/// is truncated, and no tool takes it.
class SectionWriter {
 public:
  /// Writes to `fd`, which the caller keeps open; `name` is for messages.
  /// @throw std::system_error
  SectionWriter(int fd, const std::string& name, const SectionHeader& header,
                Packing packing = Packing::kFast);
  ~SectionWriter();
  SectionWriter(SectionWriter&&) noexcept;

  /// A record of a grid. `row_numbers`: row_size() of them, the state first; `links` 26 levels.
  /// @throw std::system_error
  void record(PointIndex point, Level level, std::uint32_t generation, const double* row_numbers,
              const Level* links);
  /// A grid's records [begin, end) of `rows`. @throw std::system_error
  void records(const RecordRun& rows, std::size_t begin, std::size_t end);
  /// What the conversions of a source record reached. `rows`: 26 x row_size() numbers, of which
  /// those of the `directions` count, one at least. @throw std::system_error
  void requests(PointIndex point, Level level, DirectionMask directions, const double* rows);

  /// Writes what is left, the footer and the locator. @throw std::system_error
  void finish();

 private:
  class Encoder;

  /// A chunk of a grid ends where its range of points ends.
  void enter_range(PointIndex point);
  void count_frontier(PointIndex point, std::uint32_t generation);
  void flush();

  Section section_;
  std::uint32_t row_size_;
  Neighbourhood neighbourhood_;
  std::unique_ptr<Encoder> encoder_;
  Digest header_digest_;
  // The rows of the chunk that is being filled: rows_ of them, row_limit_ at most. The columns are
  // not initialised, because a small section touches little of them.
  std::unique_ptr<PointIndex[]> point_;
  std::unique_ptr<Level[]> level_;
  std::unique_ptr<double[]> numbers_;            // row_limit_ x row_size_
  std::unique_ptr<std::uint32_t[]> generation_;  // of a grid, as the links
  std::unique_ptr<Level[]> links_;
  std::unique_ptr<DirectionMask[]> directions_;  // of requests
  std::size_t rows_ = 0;
  std::uint32_t frontier_ = 0;     // of the rows
  std::uint32_t conversions_ = 0;  // that these ask for; of requests: how many there are
  std::uint64_t range_end_ = 0;    // of a grid's chunk: the first point behind its range
  std::uint32_t row_limit_;        // of a chunk: its records and its points, or its requests
};

}  // namespace hapgrid
