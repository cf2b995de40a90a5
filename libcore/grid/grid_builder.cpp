#include "libcore/grid/grid_builder.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/parallel.hpp"
#include "libcore/grid/point_bits.hpp"
#include "libcore/grid/record_order.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kCompared = 16;  // records at once
constexpr double kMostFinite = std::numeric_limits<double>::max();

/// How many rows have a number that is not finite.
std::uint64_t count_not_finite(std::span<const double> rows, std::size_t width) {
  std::uint64_t wrong = 0;
  for (const double number : rows) wrong += !(std::abs(number) <= kMostFinite);
  if (wrong == 0) return 0;
  std::uint64_t count = 0;
  for (std::size_t begin = 0; begin < rows.size(); begin += width) {
    const auto row = rows.subspan(begin, width);
    count += !std::all_of(row.begin(), row.end(), [](double v) { return std::isfinite(v); });
  }
  return count;
}

/// The numbers of links that a run of records had, in a few slots.
class Recent {
 public:
  struct Slot {
    bool is_used = false;
    DirectionMask inside = 0;
    std::size_t record = 0;  // of the run: one that has the links
    std::uint32_t number = 0;
  };

  Slot& of(const Level* levels, DirectionMask inside) {
    std::array<std::uint64_t, 4> words{};
    std::memcpy(words.data(), levels, kDirections);
    std::uint64_t hash = inside;
    for (const std::uint64_t word : words) hash = (hash ^ word) * 0x9e3779b97f4a7c15;
    return slots_[hash >> 58];
  }

 private:
  std::array<Slot, 64> slots_{};
};

}  // namespace

GridBuilder::GridBuilder(GridSpec spec, std::uint32_t generation, bool has_tears,
                         std::uint64_t records, Generations generations)
    : grid_(std::move(spec), generation), records_(records), is_upper_((records + 63) / 64) {
  if (records >= Grid::kNoRecord) throw FormatError("grid: more than 4294967294 records");
  grid_.has_tears_ = has_tears;
  if (generations == Generations::kKept) grid_.generation_of_ = LargeArray<std::uint32_t>(records);
  grid_.rows_ = RowBlocks(records, grid_.row_size_);
  grid_.links_of_ = LinkNumbers(records);
}

void GridBuilder::require_shapes(std::uint64_t first, const RecordRun& run) const {
  const std::size_t count = run.point.size();
  if (first > records_ || count > records_ - first || run.level.size() != count ||
      run.generation.size() != count || run.rows.size() != count * grid_.row_size_ ||
      run.links.size() != count * kDirections ||
      run.tears.size() != (grid_.has_tears_ ? count * kDirections : 0))
    throw FormatError("grid: columns of different lengths");
}

void GridBuilder::add(std::uint64_t first, const RecordRun& run) {
  require_shapes(first, run);
  const std::size_t count = run.point.size();
  if (count == 0) return;
  Run known = check_order(first, run);
  add_links(first, run);
  // Records come from the corner of the box, where nothing pushes most models.
  std::call_once(shared_, [&] { grid_.rows_.share(run.rows.first(grid_.row_size_)); });
  grid_.rows_.set(first, run.rows, rows_mutex_);
  if (!grid_.generation_of_.empty())
    std::copy(run.generation.begin(), run.generation.end(), grid_.generation_of_.data() + first);
  const auto frontier = static_cast<std::uint64_t>(
      std::count(run.generation.begin(), run.generation.end(), grid_.generation_));
  const std::uint64_t not_finite = count_not_finite(run.rows, grid_.row_size_);
  const std::lock_guard lock(runs_mutex_);
  grid_.frontier_ += frontier;
  grid_.not_finite_ += not_finite;
  runs_.push_back(std::move(known));
}

/// Within the run; join_runs() looks at what is between runs. Marks the records of upper levels.
GridBuilder::Run GridBuilder::check_order(std::uint64_t first, const RecordRun& run) {
  const std::size_t count = run.point.size();
  Run known{first, count, run.point.front(), run.point.back(), run.level.front(), run.level.back()};
  if (is_plain(run.point, run.level) && run.point.back() < grid_.box().points()) return known;
  RecordOrder order(grid_.spec_, run.level[0]);
  std::size_t distinct = 1;
  for (std::size_t r = 0; r < count; ++r)
    distinct += order.next(first + r, run.point[r], run.level[r]);
  if (std::uint64_t{known.last_point} - known.first_point + 1 != distinct)
    known.points.assign(run.point.begin(), run.point.end());
  mark_upper(first, run.level);
  return known;
}

void GridBuilder::mark_upper(std::uint64_t first, std::span<const Level> level) {
  for (std::size_t r = 0; r < level.size();) {
    const std::uint64_t place = first + r;
    std::uint64_t bits = 0;
    const std::size_t end = std::min<std::size_t>(level.size(), r + 64 - place % 64);
    for (std::uint64_t i = place % 64; r < end; ++r, ++i) bits |= std::uint64_t{level[r] > 0} << i;
    // Runs can share a word.
    if (bits != 0) std::atomic_ref(is_upper_[place / 64]).fetch_or(bits, std::memory_order_relaxed);
  }
}

void GridBuilder::add_links(std::uint64_t first, const RecordRun& run) {
  const std::size_t count = run.point.size();
  std::vector<std::uint32_t> numbers(count);
  InsideOfRun inside_of(grid_.spec_.box, grid_.neighbourhood_);
  const auto levels = [&](std::size_t r) { return &run.links[r * kDirections]; };
  const auto tears = [&](std::size_t r) {
    return grid_.has_tears_ ? &run.tears[r * kDirections] : nullptr;
  };
  // Of `n` records from a and from b on.
  const auto same = [&](std::size_t a, std::size_t b, std::size_t n) {
    return std::memcmp(levels(a), levels(b), n * kDirections) == 0 &&
           (!grid_.has_tears_ || std::memcmp(tears(a), tears(b), n * kDirections) == 0);
  };
  Recent recent;
  for (std::size_t r = 0; r < count;) {
    const DirectionMask inside = inside_of(run.point[r]);
    Recent::Slot& slot = recent.of(levels(r), inside);
    if (slot.inside != inside || !slot.is_used || !same(r, slot.record, 1))
      slot = {true, inside, r, number_of(make_links(levels(r), tears(r), inside))};
    // Most of those that follow have the same: they are compared with the records before them.
    std::size_t end = r + 1;
    for (std::size_t n : {kCompared, std::size_t{1}})
      while (end + n <= count && inside_of.is_same(run.point[end + n - 1]) && same(end, end - 1, n))
        end += n;
    std::fill(numbers.begin() + static_cast<std::ptrdiff_t>(r),
              numbers.begin() + static_cast<std::ptrdiff_t>(end), slot.number);
    r = end;
  }
  grid_.links_of_.set(first, numbers, links_mutex_);
}

std::uint32_t GridBuilder::number_of(const Links& links) {
  const std::lock_guard lock(table_mutex_);
  return grid_.table_.add(links);
}

/// Brings the runs into order, and checks that each goes on where the one before ends.
void GridBuilder::join_runs() {
  std::sort(runs_.begin(), runs_.end(),
            [](const Run& a, const Run& b) { return a.first < b.first; });
  std::uint64_t next = 0;
  const Run* before = nullptr;
  for (const Run& run : runs_) {
    if (run.first != next) throw FormatError("grid: records are missing or there twice");
    RecordOrder order(grid_.spec_, before ? before->last_level : 0);
    if (before) order.next(run.first - 1, before->last_point, before->last_level);
    order.next(run.first, run.first_point, run.first_level);
    next += run.size;
    before = &run;
  }
  if (next != records_) throw FormatError("grid: records are missing or there twice");
}

/// Empty where each point has a record.
std::vector<PointIndex> GridBuilder::points_of_records() {
  std::uint64_t upper = 0;
  for (const std::uint64_t word : is_upper_)
    upper += static_cast<std::uint64_t>(std::popcount(word));
  std::vector<PointIndex> points;
  if (records_ - upper == grid_.box().points()) return points;
  points.reserve(records_);
  for (const Run& run : runs_) {
    points.insert(points.end(), run.points.begin(), run.points.end());
    PointIndex p = run.first_point;
    for (std::uint64_t r = run.first; run.points.empty() && r < run.first + run.size; ++r) {
      if (r > run.first && !(is_upper_[r / 64] >> r % 64 & 1)) ++p;
      points.push_back(p);
    }
  }
  return points;
}

Grid GridBuilder::finish() {
  require_enough_records(grid_.box(), records_);
  join_runs();
  grid_.index_ = LevelIndex(grid_.box().points(), records_, is_upper_, points_of_records());
  if (grid_.frontier_ > 0 && grid_.generation_of_.empty())
    throw FormatError("grid: a frontier without generations");
  grid_.rows_.finish();
  grid_.links_of_.finish(records_, grid_.table_.size());
  grid_.table_.finish();
  grid_.tangled_ = tangled_points(grid_, all_threads());
  return std::move(grid_);
}

}  // namespace hapgrid
