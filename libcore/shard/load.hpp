// A whole grid from shards into memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/shard/format.hpp"

namespace hapgrid {

struct LoadedGrid {
  Grid grid;
  Coding coding;  ///< how it was stored: whether its numbers may be off, and by how much
  std::uint64_t stored_bytes = 0;  ///< size of the shards as they are stored
  std::string digest = {};         ///< of the content, in hex: which grid it is
};

/// Reads the grid that `names` hold together ("-" is standard input); shards may be concatenated
/// and come in any order. Every digest and count is checked.
/// @throw FormatError when a stream is damaged, or holds requests or a part of a frontier instead
/// of a grid; std::system_error.
LoadedGrid load_grid(const std::vector<std::string>& names);

}  // namespace hapgrid
