#include "libcore/grid/record_order.hpp"

namespace hapgrid {

bool is_plain(std::span<const PointIndex> point, std::span<const Level> level) {
  if (point.empty() || std::uint64_t{point.front()} + point.size() - 1 != point.back())
    return false;
  std::uint32_t differs = 0;
  for (std::size_t r = 0; r < point.size(); ++r)
    differs |= (point[r] - point.front()) ^ static_cast<std::uint32_t>(r);
  std::uint8_t upper = 0;
  for (const Level l : level) upper |= l;
  return differs == 0 && upper == 0;
}

void require_enough_records(const Box& box, std::uint64_t records) {
  constexpr std::uint64_t kMostlyEmptyPoints = 1 << 24;
  constexpr std::uint64_t kPointsARecord = 1024;
  const std::uint64_t points = box.points();
  if (points > kMostlyEmptyPoints && points / kPointsARecord > records)
    throw FormatError("grid: a box of " + std::to_string(points) + " points with " +
                      std::to_string(records) + " records; more than " +
                      std::to_string(kMostlyEmptyPoints) + " points want a record in " +
                      std::to_string(kPointsARecord) + " of them");
}

}  // namespace hapgrid
