// The page that plays a grid by itself, without play and without a server.
#pragma once

#include <string>
#include <vector>

#include "libcore/scene/drawing.hpp"

namespace hapgrid {

/// Whether a file is a shard and no stream of frames; false for what cannot be read at any place.
/// @throw std::system_error when there is none
bool is_grid(const std::string& name);

/// @throw Error when the page would be too large, or view was built without a compiler for
/// WebAssembly; what pack_grid() and load_grid() throw
std::string grid_page(const std::string& grid, const RenderOptions& render);

}  // namespace hapgrid
