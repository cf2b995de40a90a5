// A whole grid in memory, read-only: the array X[x, l] of the paper (Sect. 2.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/base/large_array.hpp"
#include "libcore/grid/level_index.hpp"
#include "libcore/grid/link_numbers.hpp"
#include "libcore/grid/link_table.hpp"
#include "libcore/grid/row_blocks.hpp"
#include "libcore/grid/spec.hpp"

namespace hapgrid {

/// Records in columns, ascending by (point, level).
/// Shapes, for R records: `rows` R x spec.row_size() row-major (a record's row, its state first, is
/// contiguous), `links` R x 26 row-major, slot q is the destination level in direction q; `tears`
/// R x 26 like the links, or empty where the grid has no tear fractions (tear.hpp).
struct RecordColumns {
  std::vector<PointIndex> point;
  std::vector<Level> level;
  std::vector<std::uint32_t> generation;
  std::vector<double> rows;
  std::vector<Level> links;
  std::vector<TearByte> tears = {};

  std::size_t size() const { return point.size(); }
};

/// Whether a grid in memory knows the generations of its records. Play needs none.
enum class Generations { kKept, kLeftOut };

/// The levels of a point are contiguous records. A record of a complete grid takes two to three
/// bytes beside its row, for which of the distinct links it has and for its point, and four for its
/// generation if that is kept. GridBuilder (grid_builder.hpp) makes a grid from runs of records; it
/// checks what makes access safe: each point is in the box, records ascend, and the levels of a
/// point are 0, 1, 2, ... Links are *not* trusted: destination() returns kNoRecord for a link that
/// leads nowhere, and check/invariants.hpp reports it.
class Grid {
 public:
  static constexpr RecordIndex kNoRecord = ~RecordIndex{0};

  /// @param generation the round that wrote the grid: records of this generation are the frontier.
  /// @throw FormatError when the records are not a grid's.
  Grid(GridSpec spec, std::uint32_t generation, const RecordColumns& columns);

  const GridSpec& spec() const { return spec_; }
  const Box& box() const { return spec_.box; }
  const Neighbourhood& neighbourhood() const { return neighbourhood_; }
  std::uint32_t generation() const { return generation_; }
  std::uint32_t state_size() const { return spec_.state_size; }

  RecordIndex records() const { return index_.records(); }
  /// The records of point p are first(p) .. first(p) + levels(p) - 1, by level.
  RecordIndex first(PointIndex p) const { return index_.first(p); }
  RecordIndex levels(PointIndex p) const { return index_.levels(p); }
  /// Whether each of the 64 points from 64 b on has one level; false for fewer than 64.
  bool is_single(std::uint64_t b) const { return index_.is_single(b); }

  PointIndex point(RecordIndex r) const { return index_.point(r); }
  Level level(RecordIndex r) const { return static_cast<Level>(r - first(point(r))); }
  /// Of a grid that keeps them.
  std::uint32_t record_generation(RecordIndex r) const { return generation_of_[r]; }
  std::uint64_t frontier() const { return frontier_; }
  /// How many records have a number that is not finite in their rows.
  std::uint64_t not_finite() const { return not_finite_; }
  bool in_frontier(RecordIndex r) const {
    return frontier_ > 0 && generation_of_[r] == generation_;
  }
  std::span<const double> state(RecordIndex r) const { return row(r).first(spec_.state_size); }
  /// The state and the numbers stored with it.
  std::span<const double> row(RecordIndex r) const { return {rows_[r], row_size_}; }
  std::span<const Level, kDirections> links(RecordIndex r) const {
    return table_[links_of_[r]].level;
  }
  /// Whether all directions that stay in the box lead to this level number.
  bool links_lead_to(RecordIndex r, Level level) const {
    return table_[links_of_[r]].common == level;
  }
  /// The record to which direction q leads from record r; kNoRecord when the direction leaves the
  /// box, is not settled, or leads to a level that does not exist. Real-time safe.
  RecordIndex destination(RecordIndex r, int q) const {
    const Links& links = table_[links_of_[r]];
    if (!(links.usable >> q & 1)) return kNoRecord;
    const auto target = static_cast<PointIndex>(point(r) + neighbourhood_.offset(q));
    return links.level[q] < levels(target) ? first(target) + links.level[q] : kNoRecord;
  }
  /// Whether direction q of record r leads to a record whose link straight back leads elsewhere.
  /// Real-time safe.
  bool is_one_way(RecordIndex r, int q) const {
    const PointIndex p = point(r);
    return is_one_way(p, static_cast<Level>(r - first(p)), q);
  }

  /// The same of a level of point p.
  bool is_one_way(PointIndex p, Level level, int q) const {
    const Links& links = table_[links_of_[first(p) + level]];
    if (!(links.usable >> q & 1)) return false;
    const auto target = static_cast<PointIndex>(p + neighbourhood_.offset(q));
    if (links.level[q] >= levels(target)) return false;
    // The link straight back leads to this point, whatever its level.
    return table_[links_of_[first(target) + links.level[q]]].level[Direction(q).opposite().q()] !=
           level;
  }

  bool has_tears() const { return has_tears_; }
  /// The tear bytes of a record's links. Each is kNoTear or below kTearSteps; which links have one
  /// is *not* trusted, like the links.
  std::span<const TearByte, kDirections> tears(RecordIndex r) const {
    return table_[links_of_[r]].tear;
  }

 private:
  friend class GridBuilder;
  /// Without records.
  Grid(GridSpec spec, std::uint32_t generation);

  GridSpec spec_;
  Neighbourhood neighbourhood_;
  std::uint32_t generation_;
  std::uint32_t row_size_;
  bool has_tears_ = false;
  std::uint64_t frontier_ = 0;
  LevelIndex index_;
  LargeArray<std::uint32_t> generation_of_;  // kept, or there is a frontier
  RowBlocks rows_;
  std::uint64_t not_finite_ = 0;
  LinkNumbers links_of_;
  LinkTable table_;
};

}  // namespace hapgrid
