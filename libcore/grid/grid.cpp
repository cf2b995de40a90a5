#include "libcore/grid/grid.hpp"

#include <string>
#include <utility>

#include "libcore/base/error.hpp"

namespace hapgrid {

namespace {

// A header can claim any number of points in a few bytes. A finished grid has a record at each of
// them; a grid of more than so many points must have a record at least at one in a thousand.
constexpr std::uint64_t kMostlyEmptyPoints = 1 << 24;
constexpr std::uint64_t kPointsARecord = 1024;

}  // namespace

Grid::Grid(GridSpec spec, std::uint32_t generation, RecordColumns columns)
    : spec_(std::move(spec)),
      neighbourhood_(spec_.box),
      generation_(generation),
      row_size_(spec_.row_size()),
      columns_(std::move(columns)) {
  const std::size_t count = columns_.size();
  if (count >= kNoRecord) throw FormatError("grid: more than 4294967294 records");
  if (columns_.level.size() != count || columns_.generation.size() != count ||
      columns_.rows.size() != count * row_size_ || columns_.links.size() != count * kDirections ||
      (has_tears() && columns_.tears.size() != count * kDirections))
    throw FormatError("grid: columns of different lengths");
  for (const TearByte tear : columns_.tears)
    if (!is_tear_byte(tear))
      throw FormatError("grid: a tear fraction of " + std::to_string(tear) + ", at most " +
                        std::to_string(kTearSteps - 1) + " is possible");
  const std::uint64_t points = spec_.box.points();
  if (points > kMostlyEmptyPoints && points / kPointsARecord > count)
    throw FormatError("grid: a box of " + std::to_string(points) + " points with " +
                      std::to_string(count) + " records; more than " +
                      std::to_string(kMostlyEmptyPoints) + " points want a record in " +
                      std::to_string(kPointsARecord) + " of them");
  first_.assign(points + 1, 0);
  for (std::size_t r = 0; r < count; ++r) {
    const PointIndex p = columns_.point[r];
    const bool same_point = r > 0 && columns_.point[r - 1] == p;
    if (p >= points || (r > 0 && columns_.point[r - 1] > p))
      throw FormatError("grid: record " + std::to_string(r) + " has point " + std::to_string(p) +
                        ", outside the box or out of order");
    const unsigned expected = same_point ? columns_.level[r - 1] + 1u : 0u;
    if (columns_.level[r] != expected || expected >= spec_.max_levels)
      throw FormatError("grid: point " + std::to_string(p) + ": level " +
                        std::to_string(columns_.level[r]) + " where level " +
                        std::to_string(expected) + " of at most " +
                        std::to_string(spec_.max_levels) + " was expected");
    ++first_[p + 1];
  }
  for (std::uint64_t p = 0; p < points; ++p) first_[p + 1] += first_[p];
}

RecordIndex Grid::destination(RecordIndex r, int q) const {
  const Level level = links(r)[q];
  if (level >= kMaxLevels) return kNoRecord;
  const PointIndex p = columns_.point[r];
  if (!(neighbourhood_.inside(p) >> q & 1)) return kNoRecord;
  const auto target = static_cast<PointIndex>(p + neighbourhood_.offset(q));
  return level < levels(target) ? first_[target] + level : kNoRecord;
}

bool Grid::is_one_way(RecordIndex r, int q) const {
  const RecordIndex there = destination(r, q);
  return there != kNoRecord && destination(there, Direction(q).opposite().q()) != r;
}

}  // namespace hapgrid
