#include "libcore/search/ranges.hpp"

#include <algorithm>

#include "libcore/shard/format.hpp"

namespace hapgrid {

PointRange point_range(const GridSpec& spec, std::uint64_t number, std::uint64_t of) {
  const std::uint64_t points = spec.box.points();
  const std::uint64_t chunk = chunk_points(spec.row_size());
  const std::uint64_t chunks = (points + chunk - 1) / chunk;
  // Without overflow for any count: the whole parts first, then the rest.
  const auto cut = [&](std::uint64_t k) {
    return std::min(points, (chunks / of * k + chunks % of * k / of) * chunk);
  };
  return {cut(number - 1), cut(number)};
}

}  // namespace hapgrid
