#include "libcore/grid/grid.hpp"

#ifdef __linux__  // a browser has no large pages
#include <sys/mman.h>
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libcore/base/digest.hpp"
#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {

/// Reserves room for `count` values, in large pages if it is as large as two of them.
template <class T>
void reserve_large(std::vector<T>& values, std::size_t count) {
  values.reserve(count);
#ifdef __linux__
  constexpr std::uintptr_t kPage = 4096, kLargePage = 2 << 20;
  if (count * sizeof(T) < 2 * kLargePage) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(values.data());
  const std::uintptr_t page = (begin + kPage - 1) / kPage * kPage;
  // Only advice: where the kernel has no large pages, small ones do.
  ::madvise(reinterpret_cast<void*>(page), begin + count * sizeof(T) - page, MADV_HUGEPAGE);
#endif
}

}  // namespace

Links make_links(const Level* levels, DirectionMask inside) {
  Links links;
  std::copy_n(levels, kDirections, links.level.begin());
  for (int q = 0; q < kDirections; ++q)
    if (links.level[q] < kMaxLevels) links.usable |= DirectionMask{1} << q;
  links.usable &= inside;
  return links;
}

Grid::Grid(GridSpec spec, std::uint32_t generation)
    : spec_(std::move(spec)),
      neighbourhood_(spec_.box),
      generation_(generation),
      row_size_(spec_.row_size()) {}

namespace {

Grid grid_of(GridSpec spec, std::uint32_t generation, const RecordRun& records) {
  GridBuilder builder(std::move(spec), generation, records.point.size());
  builder.add(0, records);
  return builder.finish();
}

}  // namespace

Grid::Grid(GridSpec spec, std::uint32_t generation, const RecordRun& records)
    : Grid(grid_of(std::move(spec), generation, records)) {}

namespace {

/// Each point is in the box, points ascend, and the levels of a point are 0, 1, 2, ...
void require_order(const GridSpec& spec, std::span<const PointIndex> point,
                   std::span<const Level> level) {
  std::uint32_t expected = 0;  // level
  for (std::size_t r = 0; r < point.size(); ++r) {
    const bool is_other = r > 0 && point[r] != point[r - 1];
    if (point[r] >= spec.box.points() || (is_other && point[r] < point[r - 1]))
      throw FormatError(
          format("grid: record {} has point {}, outside the box or out of order", r, point[r]));
    if (is_other) expected = 0;
    if (level[r] != expected || level[r] >= spec.max_levels)
      throw FormatError(format("grid: point {}: level {} where level {} of at most {} was expected",
                               point[r], level[r], expected, spec.max_levels));
    ++expected;
  }
}

/// The columns of `count` records must have their shapes.
void require_lengths(const RecordRun& run, std::size_t count, std::size_t row_size) {
  if (run.point.size() != count || run.level.size() != count || run.generation.size() != count ||
      run.rows.size() != count * row_size || run.links.size() != count * kDirections)
    throw FormatError("grid: columns of different lengths");
}

}  // namespace

void require_possible(const Box& box, std::uint64_t records) {
  constexpr std::uint64_t kMostlyEmptyPoints = 1 << 24;
  constexpr std::uint64_t kPointsARecord = 1024;
  if (records >= Grid::kNoRecord) throw FormatError("grid: more than 4294967294 records");
  const std::uint64_t points = box.points();
  if (points > kMostlyEmptyPoints && points / kPointsARecord > records)
    throw FormatError(
        format("grid: a box of {} points with {} records; more than {} points want a record in {} "
               "of them",
               points, records, kMostlyEmptyPoints, kPointsARecord));
}

namespace {

std::size_t hash_of(const Links& links) {
  // The bytes behind `usable` are padding, which has any value.
  const auto bytes = std::as_bytes(std::span(&links, 1));
  return digest_of(bytes.first(offsetof(Links, usable) + sizeof(links.usable))).low;
}

}  // namespace

GridBuilder::GridBuilder(GridSpec spec, std::uint32_t generation, std::uint64_t records)
    : grid_(std::move(spec), generation), numbers_(0, hash_of) {
  require_possible(grid_.box(), records);
  grid_.point_.resize(records);
  grid_.generation_of_.resize(records);
  // What a step of play reads.
  reserve_large(grid_.rows_, records * grid_.row_size_);
  reserve_large(grid_.links_of_, records);
  grid_.rows_.resize(records * grid_.row_size_);
  grid_.links_of_.resize(records);
  level_.resize(records);
}

void GridBuilder::add(std::uint64_t first, const RecordRun& run) {
  const std::size_t count = run.point.size();
  if (first > level_.size() || count > level_.size() - first)
    throw FormatError("grid: more records than were announced");
  require_lengths(run, count, grid_.row_size_);
  std::copy(run.point.begin(), run.point.end(), grid_.point_.data() + first);
  std::copy(run.level.begin(), run.level.end(), level_.data() + first);
  std::copy(run.generation.begin(), run.generation.end(), grid_.generation_of_.data() + first);
  std::copy(run.rows.begin(), run.rows.end(), grid_.rows_.data() + first * grid_.row_size_);
  add_links(first, count, run.links.data());
}

void GridBuilder::add_links(std::uint64_t first, std::size_t count, const Level* links) {
  DirectionMask inside_before = 0;
  for (std::size_t r = 0; r < count; ++r) {
    const Level* const levels = links + r * kDirections;
    const DirectionMask inside = grid_.neighbourhood_.inside(grid_.point_[first + r]);
    const bool is_as_before = r > 0 && inside == inside_before &&
                              std::equal(levels, levels + kDirections, levels - kDirections);
    grid_.links_of_[first + r] =
        is_as_before ? grid_.links_of_[first + r - 1] : number_of(make_links(levels, inside));
    inside_before = inside;
  }
  added_ += count;
}

std::uint32_t GridBuilder::number_of(const Links& links) {
  std::vector<Links>& known = grid_.distinct_links_;
  // Neighbours are mostly alike.
  if (last_ < known.size() && known[last_] == links) return last_;
  const auto [found, is_new] =
      numbers_.try_emplace(links, static_cast<std::uint32_t>(known.size()));
  if (is_new) known.push_back(links);
  return last_ = found->second;
}

Grid GridBuilder::finish() {
  if (added_ != level_.size()) throw FormatError("grid: records are missing or there twice");
  require_order(grid_.spec_, grid_.point_, level_);
  const std::uint64_t points = grid_.box().points();
  const bool has_one_level =
      std::all_of(level_.begin(), level_.end(), [](Level level) { return level == 0; });
  if (!has_one_level || grid_.records() != points) {  // else a point has the record of its number
    reserve_large(grid_.first_, points + 1);
    for (RecordIndex r = 0; r < grid_.records(); ++r)
      while (grid_.first_.size() <= grid_.point_[r]) grid_.first_.push_back(r);
    grid_.first_.resize(points + 1, grid_.records());
  }
  grid_.distinct_links_.shrink_to_fit();
  numbers_.clear();
  level_ = {};
  return std::move(grid_);
}

}  // namespace hapgrid
