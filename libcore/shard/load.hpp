// A whole grid from a shard into memory.
#pragma once

#include <cstdint>
#include <string>

#include "libcore/grid/grid.hpp"
#include "libcore/shard/section.hpp"

namespace hapgrid {

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
