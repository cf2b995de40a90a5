// Reading the chunks of a section. Everything in a shard is checked before it is used; what is
// handed out is safe to index with, except for links, whose destination may not exist.
#pragma once

#include <memory>

#include "libcore/shard/section.hpp"

namespace hapgrid {

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

  /// The next chunk of a grid or a frontier as it is stored; its frame is checked against the
  /// footer's hash, its content not looked at. @throw FormatError
  void next_stored(StoredChunk& chunk);
  /// Goes on behind the next chunk, of which nothing is needed and nothing checked.
  /// @throw FormatError
  void pass_over();
  /// Decodes what next_stored() gave. @throw FormatError
  void decode(const StoredChunk& chunk, RecordRows& rows);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace hapgrid
