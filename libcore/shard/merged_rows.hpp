// The rows of several sections in one order.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "libcore/shard/reader.hpp"

namespace hapgrid {

/// Rows [begin, end) of `rows`.
template <class Rows>
struct Run {
  const Rows* rows = nullptr;
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// The rows of several sections as one ascending sequence, run by run. A section is opened when the
/// sequence reaches its first point and closed behind its last row, so memory follows the sections
/// that overlap and not their number. Rows with equal keys come one after the other.
template <class Rows>
class MergedRows {
 public:
  /// `sections` must outlive this object.
  explicit MergedRows(const std::vector<Section>& sections);
  ~MergedRows();

  /// The next run, valid until the next call; empty behind the last.
  /// @throw FormatError, std::system_error
  Run<Rows> next();

  /// The section that alone holds the next rows, when they begin with a whole chunk that was not
  /// decoded yet; nullptr otherwise. Its chunks may be taken from it past this object. Ends the
  /// last run.
  SectionReader* whole_chunk_next();

 private:
  struct Source;
  void end_run();
  /// Whether no other section has rows where the next chunk of this open one is.
  bool alone(const Source& source) const;
  void open_next();

  std::vector<const Section*> waiting_;  // by first point, descending
  std::vector<std::unique_ptr<Source>> open_;
  Source* current_ = nullptr;
};

extern template class MergedRows<RecordRows>;
extern template class MergedRows<RequestRows>;

}  // namespace hapgrid
