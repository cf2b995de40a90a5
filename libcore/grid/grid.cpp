#include "libcore/grid/grid.hpp"

#include <utility>

#include "libcore/grid/grid_builder.hpp"

namespace hapgrid {

Grid::Grid(GridSpec spec, std::uint32_t generation)
    : spec_(std::move(spec)),
      neighbourhood_(spec_.box),
      generation_(generation),
      row_size_(spec_.row_size()) {}

Grid::Grid(GridSpec spec, std::uint32_t generation, RecordColumns columns)
    : Grid(GridBuilder(std::move(spec), generation, std::move(columns)).finish()) {}

}  // namespace hapgrid
