#include "libcore/check/reachable.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "libcore/grid/describe.hpp"

namespace hapgrid {

DistanceRows::DistanceRows(const Box& box)
    : box_(box),
      reachable_{
          "reachable", "records", "records that no chain of links leads to from the seeds", {}},
      generations_{"generations",
                   "records",
                   "records whose generation is not their distance from the seeds, in links, or "
                   "less than that of a level below",
                   {}} {}

void DistanceRows::add(PointIndex point, Level level, std::uint32_t generation,
                       std::uint32_t distance) {
  const Place place{point, level, {}};
  ++reachable_.found.counted;
  generations_.found.counted += distance != kUnreached;
  const auto offend = [&](const char* beside, std::uint32_t other) {
    generations_.found.offend(place, [&] {
      return describe(box_, point, level) + ": generation " + std::to_string(generation) + beside +
             std::to_string(other);
    });
  };
  if (distance == kUnreached)
    reachable_.found.offend(place, [&] { return describe(box_, point, level); });
  else if (distance != generation)
    offend(", distance ", distance);
  else if (level > 0 && generation_before_ > generation)
    // Play starts at level 0: the numbers of levels, by when they were found, matter.
    offend(", the level below has ", generation_before_);
  generation_before_ = generation;
  youngest_ = std::max(youngest_, generation);
}

std::vector<Check> DistanceRows::finish(std::uint32_t generation) {
  // The last round finds nothing new.
  if (reachable_.found.counted > 0 && generation > youngest_ + 1)
    generations_.found.offend([&] {
      return "the grid has generation " + std::to_string(generation) + ", its youngest record " +
             std::to_string(youngest_);
    });
  return {std::move(reachable_), std::move(generations_)};
}

std::vector<Check> check_reachable(const Grid& grid) {
  std::vector<std::uint32_t> distance(grid.records(), DistanceRows::kUnreached);
  // Breadth first: `reached` is the queue, and keeps what has left it.
  std::vector<RecordIndex> reached;
  for (RecordIndex r = 0; r < grid.records(); ++r) {
    if (grid.record_generation(r) != 0) continue;
    distance[r] = 0;
    reached.push_back(r);
  }
  for (std::size_t head = 0; head < reached.size(); ++head) {
    const RecordIndex r = reached[head];
    for (int q = 0; q < kDirections; ++q) {
      const RecordIndex target = grid.destination(r, q);
      if (target == Grid::kNoRecord || distance[target] != DistanceRows::kUnreached) continue;
      distance[target] = distance[r] + 1;
      reached.push_back(target);
    }
  }
  DistanceRows rows(grid.box());
  for (RecordIndex r = 0; r < grid.records(); ++r)
    rows.add(grid.point(r), grid.level(r), grid.record_generation(r), distance[r]);
  return rows.finish(grid.generation());
}

}  // namespace hapgrid
