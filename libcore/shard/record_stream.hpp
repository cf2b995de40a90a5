// The records of one section, taken in order, with what nobody needs left undecoded.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "libcore/shard/merged_rows.hpp"

namespace hapgrid {

/// Points ascend in all calls. The section is opened when its first chunk is needed.
class RecordStream {
 public:
  /// `section`, of a grid, must outlive this object.
  explicit RecordStream(const Section& section) : section_(&section) {}

  /// The point of the next record; where its chunk is not decoded yet, a point not behind it.
  /// 2^64 - 1 behind the last.
  std::uint64_t next_point() const;

  /// Forgets the records before `point`. @throw FormatError, std::system_error, as all here
  void skip_before(std::uint64_t point);

  /// The next records before `end`, as far as one chunk holds them, valid until the next call;
  /// empty where there are none.
  Run<RecordRows> next_before(std::uint64_t end);

  /// Fetches the chunks that begin before `end` and were not yet, without taking their records:
  /// those that are `wanted` are decoded for f(rows), the others stay as they are stored.
  /// skip_before() fetches none, so f sees each wanted chunk that begins before what next_before()
  /// is asked for.
  template <class Wanted, class F>
  void look_ahead(std::uint64_t end, Wanted&& wanted, F&& f) {
    for (const ChunkInfo* next = next_chunk(); next && next->first_point < end;
         next = next_chunk()) {
      if (wanted(*next))
        f(fetch_decoded().rows);
      else
        fetch_stored();
    }
  }

  /// Whether the records before `end` are some chunks that are not decoded and hold no others, in
  /// the form of a plain grid.
  bool is_stored_before(std::uint64_t end) const;
  /// The next of these chunks.
  void take_stored(StoredChunk& chunk);

  /// Passes over what is left and compares the footer's sums with what was there.
  void finish();

 private:
  /// A chunk that was read: as it is stored, or decoded.
  struct Fetched {
    StoredChunk stored;
    RecordRows rows;
    bool is_decoded = false;
    std::size_t position = 0;  // of the next of the rows
  };

  SectionReader& reader();
  /// The next chunk that is not fetched; nullptr behind the last.
  const ChunkInfo* next_chunk() const;
  Fetched& fetch();
  Fetched& fetch_decoded();
  void fetch_stored();
  /// The first chunk fetched, decoded.
  Fetched& front();
  void drop_front();

  const Section* section_;
  std::optional<SectionReader> reader_;
  std::uint64_t from_ = 0;  // records before are forgotten
  std::deque<std::unique_ptr<Fetched>> fetched_;
  std::unique_ptr<Fetched> taken_;  // the chunk of the last run
  std::vector<std::unique_ptr<Fetched>> spare_;
};

}  // namespace hapgrid
