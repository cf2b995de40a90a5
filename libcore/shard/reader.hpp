// Reading the chunks of a section. Everything in a shard is checked before it is used; what is
// handed out is safe to index with, except for links, whose destination may not exist.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/zstd_frame.hpp"
#include "libcore/grid/grid.hpp"
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

 private:
  template <class Rows>
  void decode(std::size_t chunk, Rows& rows);
  /// Of the rows: how many are in the frontier, and the conversions.
  std::pair<std::uint32_t, std::uint32_t> check(const RecordRows& rows) const;
  std::pair<std::uint32_t, std::uint32_t> check(RequestRows& rows) const;
  void check_order(const Chunk& rows) const;

  const Section* section_;
  Neighbourhood neighbourhood_;
  ZstdFrameDecoder decoder_{"shard"};
  std::vector<std::byte> bytes_;
};

// A whole grid from a shard into memory.

struct LoadedGrid {
  Grid grid;
  std::uint64_t stored_bytes = 0;  ///< size of the shard as it is stored
  std::string digest = {};         ///< of the content, in hex: which grid it is
};

/// Reads a grid ("-" is standard input), in as many threads as the machine has. Every digest and
/// count is checked.
/// @throw FormatError when the stream is damaged, or is not one grid; std::system_error.
LoadedGrid load_grid(const std::string& name);
LoadedGrid load_grid(const Section& section);

}  // namespace hapgrid
