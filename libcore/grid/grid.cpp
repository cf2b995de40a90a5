#include "libcore/grid/grid.hpp"

#include <utility>

#include "libcore/grid/grid_builder.hpp"

namespace hapgrid {

Grid::Grid(GridSpec spec, std::uint32_t generation)
    : spec_(std::move(spec)),
      neighbourhood_(spec_.box),
      generation_(generation),
      row_size_(spec_.row_size()) {}

namespace {

Grid grid_of(GridSpec spec, std::uint32_t generation, const RecordColumns& columns) {
  GridBuilder builder(std::move(spec), generation, columns.size());
  builder.add(0, {columns.point, columns.level, columns.generation, columns.rows, columns.links});
  return builder.finish();
}

}  // namespace

Grid::Grid(GridSpec spec, std::uint32_t generation, const RecordColumns& columns)
    : Grid(grid_of(std::move(spec), generation, columns)) {}

}  // namespace hapgrid
