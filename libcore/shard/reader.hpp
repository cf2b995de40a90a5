// Reading the chunks of a section. Everything in a shard is checked before it is used; what is
// handed out is safe to index with, except for links, whose destination may not exist.
#pragma once

#include <cstdint>
#include <span>
#include <string>
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
  void read(std::size_t chunk, Chunk& rows);

 private:
  void check_order(const Chunk& rows) const;
  void check_records(const ChunkInfo& info, const Chunk& rows) const;
  void check_requests(const ChunkInfo& info, Chunk& rows) const;

  const Section* section_;
  Neighbourhood neighbourhood_;
  std::vector<std::byte> bytes_;
};

/// Reads a whole grid ("-" is standard input) into memory, in as many threads as the machine has.
/// Every digest and count is checked.
/// @throw FormatError when the stream is damaged, or is not one grid; std::system_error.
Grid load_grid(const std::string& name);
Grid load_grid(const Section& section);

}  // namespace hapgrid
