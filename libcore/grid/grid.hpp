// A whole grid in memory, read-only: the array X[x, l] of the paper (Sect. 2.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "libcore/grid/direction.hpp"
#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// The links of a record. Half a cache line.
struct alignas(32) Links {
  std::array<Level, kDirections> level;  ///< the destination level in each direction
  /// Directions whose link may lead to a record.
  DirectionMask usable = 0;

  friend bool operator==(const Links&, const Links&) = default;
};

/// @param levels 26 @param inside the directions that stay in the box
Links make_links(const Level* levels, DirectionMask inside);

/// The position of a record in a Grid; records ascend by (point, level).
using RecordIndex = std::uint32_t;

/// R records in columns, ascending by (point, level), where somebody else keeps them: `rows` R x
/// spec.row_size() row-major (a record's row, its state first, is contiguous), `links` R x 26
/// row-major, slot q is the destination level in direction q.
struct RecordRun {
  std::span<const PointIndex> point;
  std::span<const Level> level;
  std::span<const std::uint32_t> generation;
  std::span<const double> rows;
  std::span<const Level> links;
};

/// The same where they are kept.
struct RecordColumns {
  std::vector<PointIndex> point;
  std::vector<Level> level;
  std::vector<std::uint32_t> generation;
  std::vector<double> rows;
  std::vector<Level> links;

  std::size_t size() const { return point.size(); }
  operator RecordRun() const { return {point, level, generation, rows, links}; }
};

/// The levels of a point are contiguous records. A record takes 16 bytes beside its row: its point,
/// its generation, which of the distinct links it has, and where its point's records begin.
/// GridBuilder checks what makes access safe: each point is in the box, records ascend, and the
/// levels of a point are 0, 1, 2, ... Links are *not* trusted: destination() returns kNoRecord for
/// a link that leads nowhere, and verify reports it.
class Grid {
 public:
  static constexpr RecordIndex kNoRecord = ~RecordIndex{0};

  /// @param generation the round that wrote the grid: records of this generation are the frontier.
  /// @throw FormatError when the records are not a grid's.
  Grid(GridSpec spec, std::uint32_t generation, const RecordRun& records);

  const GridSpec& spec() const { return spec_; }
  const Box& box() const { return spec_.box; }
  const Neighbourhood& neighbourhood() const { return neighbourhood_; }
  std::uint32_t generation() const { return generation_; }
  std::uint32_t state_size() const { return spec_.state_size; }

  RecordIndex records() const { return static_cast<RecordIndex>(point_.size()); }
  /// The records of point p are first(p) .. first(p) + levels(p) - 1, by level.
  RecordIndex first(PointIndex p) const { return first_.empty() ? p : first_[p]; }
  RecordIndex levels(PointIndex p) const {
    return first_.empty() ? 1 : first_[std::size_t{p} + 1] - first_[p];
  }

  PointIndex point(RecordIndex r) const { return point_[r]; }
  Level level(RecordIndex r) const { return static_cast<Level>(r - first(point_[r])); }
  std::uint32_t record_generation(RecordIndex r) const { return generation_of_[r]; }
  bool in_frontier(RecordIndex r) const { return generation_of_[r] == generation_; }
  std::span<const double> state(RecordIndex r) const { return row(r).first(spec_.state_size); }
  /// The state and the numbers stored with it.
  std::span<const double> row(RecordIndex r) const {
    return {rows_.data() + std::size_t{r} * row_size_, row_size_};
  }
  std::span<const Level, kDirections> links(RecordIndex r) const {
    return distinct_links_[links_of_[r]].level;
  }
  /// Brings what destination() reads of a record, and of a point, into the cache. Real-time safe.
  void fetch_links(RecordIndex r) const noexcept { __builtin_prefetch(links_of_.data() + r); }
  void fetch_levels(PointIndex p) const noexcept {
    if (p < first_.size()) __builtin_prefetch(first_.data() + p);
  }
  /// The record to which direction q leads from record r; kNoRecord when the direction leaves the
  /// box, is not settled, or leads to a level that does not exist. Real-time safe, as the next two.
  RecordIndex destination(RecordIndex r, int q) const {
    const Links& links = distinct_links_[links_of_[r]];
    if (!(links.usable >> q & 1)) return kNoRecord;
    const auto target = static_cast<PointIndex>(point_[r] + neighbourhood_.offset(q));
    return links.level[q] < levels(target) ? first(target) + links.level[q] : kNoRecord;
  }
  /// Whether direction q of record r leads to a record whose link straight back leads elsewhere.
  bool is_one_way(RecordIndex r, int q) const {
    const RecordIndex to = destination(r, q);
    return to != kNoRecord && !leads_back(r, q, to);
  }
  /// The record to which direction q of record r leads, if its link straight back leads to r;
  /// kNoRecord otherwise.
  RecordIndex two_way(RecordIndex r, int q) const {
    const RecordIndex to = destination(r, q);
    return to != kNoRecord && leads_back(r, q, to) ? to : kNoRecord;
  }

 private:
  friend class GridBuilder;
  /// Without records.
  Grid(GridSpec spec, std::uint32_t generation);

  bool leads_back(RecordIndex r, int q, RecordIndex to) const {
    return links(to)[static_cast<std::size_t>(Direction(q).opposite().q())] == level(r);
  }

  GridSpec spec_;
  Neighbourhood neighbourhood_;
  std::uint32_t generation_;
  std::uint32_t row_size_;
  std::vector<PointIndex> point_;
  std::vector<std::uint32_t> generation_of_;
  std::vector<double> rows_;             // records x row_size
  std::vector<std::uint32_t> links_of_;  // numbers in distinct_links_
  std::vector<Links> distinct_links_;    // most records have the same links as their neighbours
  std::vector<RecordIndex> first_;       // points + 1; empty where each point has one record
};

/// The one rule for how many records a box has, before memory is taken for its points: a header can
/// claim any number of these in a few bytes. A grid of more than 2^24 points must have a record at
/// least at one in a thousand; a finished grid has one at each.
/// @throw FormatError when there are too few records, or too many for a RecordIndex
void require_possible(const Box& box, std::uint64_t records);

/// Makes a grid from runs of records, so that no second copy of all records is in memory.
class GridBuilder {
 public:
  /// @param generation the round that wrote the grid. @param records how many there will be.
  GridBuilder(GridSpec spec, std::uint32_t generation, std::uint64_t records);

  /// Sets the records from record `first` on. Runs come in any order.
  /// @throw FormatError when a run does not fit the grid.
  void add(std::uint64_t first, const RecordRun& run);
  /// The grid; this object is empty then.
  /// @throw FormatError when the records are not a grid's, or far too few.
  Grid finish();

 private:
  /// Sets the links of `count` records from record `first` on, whose points are set.
  void add_links(std::uint64_t first, std::size_t count, const Level* links);
  /// The number of these links in the grid, which are added if they are new.
  std::uint32_t number_of(const Links& links);

  Grid grid_;
  std::vector<Level> level_;  // by record, to be checked
  std::uint64_t added_ = 0;   // records
  std::unordered_map<Links, std::uint32_t, std::size_t (*)(const Links&)> numbers_;
  std::uint32_t last_ = 0;  // number that was given
};

}  // namespace hapgrid
