// Reading the chunks of a section. Everything in a shard is checked before it is used; what is
// handed out is safe to index with, except for links, whose destination may not exist.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "libcore/base/zstd_frame.hpp"
#include "libcore/shard/section.hpp"

namespace hapgrid {

/// Reads any chunks of one section, each by its number in the index, with which it is compared.
class SectionReader {
 public:
  /// `section` must outlive this object.
  explicit SectionReader(const Section& section);

  /// Decodes a chunk. Its rows ascend; whether they come behind those of the chunk before is for
  /// the caller to check, since a point can be in both. @throw FormatError, std::system_error
  void read(std::size_t chunk, RecordRows& rows);
  void read(std::size_t chunk, RequestRows& rows);
  void read(std::size_t chunk, TearRows& rows);

  /// A chunk as it is stored: its zstd frame is checked against the footer's hash, and its content
  /// is not looked at. @throw FormatError, std::system_error
  void read_stored(std::size_t chunk, StoredChunk& stored);

 private:
  template <class Rows>
  void decode(std::size_t chunk, Rows& rows);
  void read_bytes(const ChunkInfo& info, std::vector<std::byte>& bytes);
  /// Of the rows: how many are in the frontier, and the conversions.
  struct Counts {
    std::uint32_t frontier = 0;
    std::uint32_t conversions = 0;
  };
  Counts check(const RecordRows& rows) const;
  Counts check(RequestRows& rows) const;
  Counts check(const TearRows& rows) const;
  void check_order(const Chunk& rows) const;

  const Section* section_;
  Neighbourhood neighbourhood_;
  ZstdFrameDecoder decoder_{"shard"};
  std::vector<std::byte> bytes_;
};

}  // namespace hapgrid
