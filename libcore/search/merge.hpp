// The merge filter: lines 10 to 20 of Algorithm 1 for one generation.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcore/model/model.hpp"
#include "libcore/search/converter.hpp"
#include "libcore/shard/reader.hpp"
#include "libcore/shard/section.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

// The requests of many shards in one order.

/// What the conversions of one source record reached.
struct SourceRequests {
  PointIndex point = 0;
  Level level = 0;
  DirectionMask directions = 0;
  const double* rows = nullptr;  ///< one for each of the directions, ascending
  std::size_t width = 0;         ///< numbers a row

  /// The row of direction q, which must be one of the directions.
  const double* row(int q) const {
    if (directions == kAllDirections) return rows + width * static_cast<unsigned>(q);
    const DirectionMask before = directions & ((DirectionMask{1} << q) - 1);
    return rows + width * static_cast<unsigned>(std::popcount(before));
  }
};

/// Reads any number of sections side by side, source record by source record, ascending by (point,
/// level). Requests of one record may come from several sections, and the same request several
/// times. Memory: a chunk a section, while it is read.
class RequestReader {
 public:
  /// `sections` must outlive this object.
  explicit RequestReader(const std::vector<Section>& sections);
  ~RequestReader();

  /// The next source record, valid until the next call; false behind the last.
  /// @throw FormatError when a section is damaged, or when requests contradict each other;
  /// std::system_error
  bool next(SourceRequests& source);

 private:
  struct Stream;
  static bool later(const std::unique_ptr<Stream>& a, const std::unique_ptr<Stream>& b);
  void push(std::unique_ptr<Stream> stream);
  bool select_first();
  void gather(const SourceRequests& more, DirectionMask& known);

  std::vector<std::unique_ptr<Stream>> heap_;  // the one with the smallest key in front
  std::unique_ptr<Stream> first_;              // was taken out of it
  bool given_ = false;                         // its row is what next() gave
  // Of a record that several sections have requests of:
  std::vector<double> spread_;  // 26 rows
  std::vector<double> rows_;    // those of its directions
};

/// Takes the grid out of the sections, and leaves the requests.
/// @throw FormatError unless there is one grid, and all the others are of its generation.
Section take_grid(std::vector<Section>& sections);

/// The header of the merged grid. A grid whose frontier is empty keeps its generation.
SectionHeader merged_header(const Section& grid);

/// Merges a whole round: each of the conversions of the grid's frontier must be among the requests;
/// when it has no frontier, it is copied. Memory: the whole grid, and a chunk of each section of
/// requests. Writes to `fd`, which the caller keeps open, and nothing before all requests are
/// settled; `name` is for messages.
/// @throw FormatError when requests are missing (it counts them), contradict each other, or were
/// not asked for; Error (level limit), ModelError, std::system_error.
void merge(const Section& grid, const std::vector<Section>& requests, const Model& model, int fd,
           const std::string& name, Progress& progress);

/// Writes the records of a finished grid to `out`, which cuts them into its own chunks, and
/// finishes it. @throw Error when the frontier is not empty; FormatError, std::system_error
void copy_finished(const Section& grid, SectionWriter& out);

}  // namespace hapgrid
