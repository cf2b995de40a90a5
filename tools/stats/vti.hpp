// A grid as an image that ParaView and VTK open.
#pragma once

#include <string>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// Point data: `levels`, how many each point has; and of the records at `level` the `state`, and
/// where the grid stores them `force` and `energy`; NaN where a point has no such level. Lengths
/// are the model's. Source: VTK File Formats, "ImageData", appended raw data.
/// @throw std::system_error
void write_vti(const Grid& grid, unsigned level, const std::string& file);

}  // namespace hapgrid
