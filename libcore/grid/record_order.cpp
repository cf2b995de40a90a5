#include "libcore/grid/record_order.hpp"

namespace hapgrid {

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
