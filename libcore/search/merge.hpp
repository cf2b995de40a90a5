// The merge filter: lines 10 to 20 of Algorithm 1 for one generation.
#pragma once

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

/// Reads any number of sections side by side, source record by source record, ascending by (point,
/// level). Requests of one record may come from several sections, and the same request several
/// times. Memory: a chunk a section, while it is read.
class RequestReader {
 public:
  /// `sections` must outlive this object.
  explicit RequestReader(const std::vector<Section>& sections);
  ~RequestReader();

  /// The next source record, without its state; false behind the last.
  /// @throw FormatError when a section is damaged, or when requests contradict each other;
  /// std::system_error
  bool next(FrontierRecord& source);
  /// What its conversions reached, valid until the next call: the row of a direction of its `todo`.
  const double* row(int q) const { return &rows_[static_cast<unsigned>(q) * width_]; }

 private:
  struct Stream;
  static bool later(const std::unique_ptr<Stream>& a, const std::unique_ptr<Stream>& b);
  void push(std::unique_ptr<Stream> stream);
  bool select_first();
  void gather(FrontierRecord& source);

  std::vector<std::unique_ptr<Stream>> heap_;  // the one with the smallest key in front
  std::unique_ptr<Stream> first_;              // was taken out of it
  std::size_t width_ = 0;                      // numbers a row
  std::vector<double> rows_;  // 26 rows, of which those of the record's directions count
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
