// Which sections an input holds, known from their headers and footers.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/file.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

/// One section of an input, known from its header and footer. The points of its chunks ascend, and
/// their zstd frames lie where the index says.
struct Section {
  std::shared_ptr<const InputFile> file;
  std::uint64_t begin = 0;  ///< in the file, with header and locator
  std::uint64_t end = 0;
  SectionHeader header;
  // Its index, the footer:
  std::uint32_t header_size = 0;  ///< of the header's zstd frame
  std::vector<ChunkInfo> chunks;
  Digest digest;

  std::uint64_t size() const { return end - begin; }  ///< bytes, as it is stored
  std::string name() const;                           ///< its digest in hex: which grid it is
  std::uint64_t records() const;                      ///< of requests: their source records
  std::uint64_t frontier() const;                     ///< records
  std::uint64_t conversions() const;  ///< that the frontier asks for; of requests: how many
};

/// The sections of all inputs, by input and place. Only headers and footers are decoded.
/// @throw FormatError when an input is empty, truncated or damaged, or when the headers do not
/// describe the same grid; std::system_error.
std::vector<Section> open_sections(const std::vector<std::string>& names);

/// A grid. @throw FormatError also when the input is anything else than one section with a grid.
Section open_grid(const std::string& name);
Section open_grid(const std::shared_ptr<const InputFile>& file);

}  // namespace hapgrid
