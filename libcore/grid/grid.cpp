#include "libcore/grid/grid.hpp"

#include <utility>

#include "libcore/grid/grid_builder.hpp"

namespace hapgrid {

Grid::Grid(GridSpec spec, std::uint32_t generation)
    : spec_(std::move(spec)),
      neighbourhood_(spec_.box),
      generation_(generation),
      row_size_(spec_.row_size()) {}

Grid::Grid(GridSpec spec, std::uint32_t generation, const RecordColumns& columns)
    : Grid([&] {
        GridBuilder builder(std::move(spec), generation, !columns.tears.empty(), columns.size());
        builder.add(0, {columns.point, columns.level, columns.generation, columns.rows,
                        columns.links, columns.tears});
        return builder.finish();
      }()) {}

}  // namespace hapgrid
