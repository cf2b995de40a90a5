#include "libcore/grid/grid_builder.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"

namespace hapgrid {

namespace {

// A header can claim any number of points in a few bytes. A finished grid has a record at each of
// them; a grid of more than so many points must have a record at least at one in a thousand.
constexpr std::uint64_t kMostlyEmptyPoints = 1 << 24;
constexpr std::uint64_t kPointsARecord = 1024;

/// @param inside the directions that stay in the box
Links make_links(const Level* levels, const TearByte* tears, DirectionMask inside) {
  Links links;
  std::copy_n(levels, kDirections, links.level.begin());
  if (tears)
    std::copy_n(tears, kDirections, links.tear.begin());
  else
    links.tear.fill(kNoTear);
  for (const TearByte tear : links.tear)
    if (!is_tear_byte(tear))
      throw FormatError("grid: a tear fraction of " + std::to_string(tear) + ", at most " +
                        std::to_string(kTearSteps - 1) + " is possible");
  for (int q = 0; q < kDirections; ++q)
    if (links.level[q] < kMaxLevels) links.usable |= DirectionMask{1} << q;
  links.usable &= inside;
  return links;
}

}  // namespace

GridBuilder::GridBuilder(GridSpec spec, std::uint32_t generation, bool has_tears,
                         std::size_t expected)
    : grid_(std::move(spec), generation) {
  grid_.has_tears_ = has_tears;
  grid_.point_.reserve(expected);
  grid_.generation_of_.reserve(expected);
  grid_.rows_.reserve(expected * grid_.row_size_);
  grid_.links_of_.reserve(expected);
}

void GridBuilder::add(const RecordRun& run) {
  const std::size_t count = run.point.size();
  if (grid_.point_.size() + count >= Grid::kNoRecord)
    throw FormatError("grid: more than 4294967294 records");
  const bool has_tears = grid_.has_tears_;
  if (run.level.size() != count || run.generation.size() != count ||
      run.rows.size() != count * grid_.row_size_ || run.links.size() != count * kDirections ||
      run.tears.size() != (has_tears ? count * kDirections : 0))
    throw FormatError("grid: columns of different lengths");
  const Level* before = nullptr;
  DirectionMask inside_before = 0;
  for (std::size_t r = 0; r < count; ++r) {
    add_point(run.point[r], run.level[r]);
    const Level* const levels = &run.links[r * kDirections];
    const TearByte* const tears = has_tears ? &run.tears[r * kDirections] : nullptr;
    const DirectionMask inside = grid_.neighbourhood_.inside(run.point[r]);
    const bool as_before = before && inside == inside_before &&
                           std::equal(levels, levels + kDirections, before) &&
                           (!tears || std::equal(tears, tears + kDirections, tears - kDirections));
    grid_.links_of_.push_back(as_before ? grid_.links_of_.back()
                                        : grid_.table_.add(make_links(levels, tears, inside)));
    before = levels;
    inside_before = inside;
  }
  grid_.generation_of_.insert(grid_.generation_of_.end(), run.generation.begin(),
                              run.generation.end());
  grid_.rows_.insert(grid_.rows_.end(), run.rows.begin(), run.rows.end());
}

void GridBuilder::add_point(PointIndex point, Level level) {
  const std::size_t r = grid_.point_.size();
  if (point >= grid_.box().points() || (r > 0 && grid_.point_[r - 1] > point))
    throw FormatError("grid: record " + std::to_string(r) + " has point " + std::to_string(point) +
                      ", outside the box or out of order");
  levels_ = r > 0 && grid_.point_[r - 1] == point ? levels_ : 0;
  const std::uint32_t expected = levels_++;
  if (level != expected || expected >= grid_.spec_.max_levels)
    throw FormatError("grid: point " + std::to_string(point) + ": level " + std::to_string(level) +
                      " where level " + std::to_string(expected) + " of at most " +
                      std::to_string(grid_.spec_.max_levels) + " was expected");
  grid_.point_.push_back(point);
}

Grid GridBuilder::finish() {
  const std::uint64_t points = grid_.box().points();
  if (points > kMostlyEmptyPoints && points / kPointsARecord > grid_.records())
    throw FormatError("grid: a box of " + std::to_string(points) + " points with " +
                      std::to_string(grid_.records()) + " records; more than " +
                      std::to_string(kMostlyEmptyPoints) + " points want a record in " +
                      std::to_string(kPointsARecord) + " of them");
  grid_.first_.reserve(points + 1);
  for (RecordIndex r = 0; r < grid_.records(); ++r)
    while (grid_.first_.size() <= grid_.point_[r]) grid_.first_.push_back(r);
  grid_.first_.resize(points + 1, grid_.records());
  grid_.table_.finish();
  return std::move(grid_);
}

}  // namespace hapgrid
