// A grid as an image that ParaView and VTK open.
#pragma once

#include <functional>
#include <string>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// Point data: `levels`, how many each point has; and of the record that `record_at` names for each
/// point the `state`, and if the grid stores them `force` and `energy`; NaN where it names
/// Grid::kNoRecord. Lengths are the model's. Source: VTK File Formats, "ImageData", appended raw
/// data.
/// @throw std::system_error
void write_vti(const Grid& grid, const std::function<RecordIndex(PointIndex)>& record_at,
               const std::string& file);

}  // namespace hapgrid
