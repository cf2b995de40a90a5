#include "libcore/check/forces.hpp"

#include <algorithm>
#include <deque>

#include "libcore/check/parallel.hpp"

namespace hapgrid {

bool has_force(const GridSpec& spec, const Model& model) {
  return spec.stored.force || model.has_force();
}

Forces::Forces(const Grid& grid, const MakeModel& create, int threads) : forces_(grid.records()) {
  const auto parts = static_cast<std::size_t>(threads);
  std::deque<Fields> fields;  // for one thread each
  for (std::size_t t = 0; t < parts; ++t)
    fields.emplace_back(grid.spec(), create, /*wants_shape=*/false);
  const std::size_t part = (forces_.size() + parts - 1) / parts;
  for_each_in_threads(parts, threads, [&](std::size_t t) {
    const auto end = static_cast<RecordIndex>(std::min(forces_.size(), (t + 1) * part));
    for (auto r = static_cast<RecordIndex>(t * part); r < end; ++r)
      forces_[r] = fields[t].force(grid.box().position(grid.point(r)), grid.row(r));
  });
}

}  // namespace hapgrid
