#include "libcore/search/ranges.hpp"

#include <algorithm>

#include "libcore/shard/format.hpp"

namespace hapgrid {

namespace {

std::uint64_t chunk_count(const GridSpec& spec) {
  const std::uint64_t chunk = chunk_points(spec.row_size());
  return (spec.box.points() + chunk - 1) / chunk;
}

}  // namespace

PointRange point_range(const GridSpec& spec, std::uint64_t number, std::uint64_t of) {
  const std::uint64_t points = spec.box.points();
  const std::uint64_t chunk = chunk_points(spec.row_size());
  const std::uint64_t chunks = chunk_count(spec);
  // Without overflow for any count: the whole parts first, then the rest.
  const auto cut = [&](std::uint64_t k) {
    return std::min(points, (chunks / of * k + chunks % of * k / of) * chunk);
  };
  return {cut(number - 1), cut(number)};
}

std::uint64_t range_count(const GridSpec& spec, std::uint64_t wanted) {
  return std::min(wanted, chunk_count(spec));
}

PointRange needed_points(const GridSpec& spec, PointRange range) {
  const auto reach = static_cast<std::uint64_t>(Neighbourhood(spec.box).reach());
  return range.widened(2 * reach);
}

}  // namespace hapgrid
