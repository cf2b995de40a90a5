// Reading shards: which sections an input holds, and their rows in order. Everything in a shard is
// checked before it is used; what these classes hand out is safe to index with, except for links,
// whose destination may not exist.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

/// One section of an input, known from its header and footer.
struct Section {
  std::shared_ptr<const InputFile> file;
  std::uint64_t begin = 0;         ///< offset behind the header's frame
  std::uint64_t end = 0;           ///< offset behind the footer's frame
  std::uint64_t stored_bytes = 0;  ///< of the whole section
  SectionHeader header;
  SectionFooter footer;
};

/// The sections of all inputs, by input and place. Only headers and footers are decoded.
/// @throw FormatError when an input is empty, truncated or damaged, or when the headers do not
/// describe the same grid; std::system_error.
std::vector<Section> open_sections(const std::vector<std::string>& names);
/// Of one input.
std::vector<Section> open_sections(const std::shared_ptr<const InputFile>& file);

/// @throw FormatError, naming input and content, unless every section holds `content`; and unless
/// all are of one generation.
void require_content(const std::vector<Section>& sections, Content content);

/// Reads the chunks of one section. Each is compared with what the footer says of it, and behind
/// the last one the footer's sums with what was read.
class SectionReader {
 public:
  /// `section` must outlive this object.
  explicit SectionReader(const Section& section);
  ~SectionReader();
  SectionReader(SectionReader&&) noexcept;

  /// What the footer says of the next chunk; nullptr behind the last.
  const ChunkInfo* peek() const;

  /// The next chunk; false behind the last. @throw FormatError
  bool next(RecordRows& rows);
  bool next(RequestRows& rows);

  /// The next chunk of a grid as it is stored; its frame is checked against the footer's hash, its
  /// content not looked at. @throw FormatError
  void next_stored(StoredChunk& chunk);
  /// Decodes what next_stored() gave. @throw FormatError
  void decode(const StoredChunk& chunk, RecordRows& rows);

 private:
  class State;
  std::unique_ptr<State> state_;
};

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
  void open_next();

  std::vector<const Section*> waiting_;  // by first point, descending
  std::vector<std::unique_ptr<Source>> open_;
  Source* current_ = nullptr;
};

extern template class MergedRows<RecordRows>;
extern template class MergedRows<RequestRows>;

}  // namespace hapgrid
