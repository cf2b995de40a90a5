// A whole grid in memory, read-only: the array X[x, l] of the paper (Sect. 2.2).
#pragma once

#include <algorithm>
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

/// A set of a box's points: bit p % 64 of word p / 64. Bits behind the last point are 0.
using PointBits = std::vector<std::uint64_t>;

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
  /// Bit i: whether record r + i does not lead to level 0 in all directions that stay in the box,
  /// for i below 64.
  std::uint64_t lead_elsewhere(RecordIndex r) const {
    std::uint64_t bits = 0;
    for (unsigned i = 0; i < 64;) {
      const std::size_t block = (r + i) / LinkNumbers::kBlock;
      const std::uint32_t shared = links_of_.of_block(block);
      const auto end =
          static_cast<unsigned>(std::min<std::size_t>(64, (block + 1) * LinkNumbers::kBlock - r));
      const bool is_known = shared < LinkNumbers::kMixed && table_[shared].common == 0;
      for (; i < end; ++i) bits |= std::uint64_t{!is_known && !links_lead_to(r + i, 0)} << i;
    }
    return bits;
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
  bool is_one_way(RecordIndex r, int q) const;

  /// Where links need a look (point_bits.hpp): around all other points each record's links lead to
  /// its own level number, so that they lead back to where they come from, or lead nowhere.
  const PointBits& tangled() const { return tangled_; }
  bool is_tangled(PointIndex p) const { return tangled_[p / 64] >> p % 64 & 1; }

  bool has_tears() const { return has_tears_; }
  /// The tear bytes of a record's links. Each is kNoTear or below kTearSteps; which links have one
  /// is *not* trusted, like the links.
  std::span<const TearByte, kDirections> tears(RecordIndex r) const {
    return table_[links_of_[r]].tear;
  }

 private:
  friend class GridBuilder;
  friend class LinksOfRecord;
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
  PointBits tangled_;
};

/// The links of one record, and which of them lead both ways. Real-time safe.
class LinksOfRecord {
 public:
  /// @param grid outlives this.
  LinksOfRecord(const Grid& grid, PointIndex p, Level level)
      : grid_(grid),
        p_(p),
        level_(level),
        is_tangled_(grid.is_tangled(p)),
        links_(grid.table_[grid.links_of_[grid.first(p) + level]]) {}
  LinksOfRecord(const Grid& grid, RecordIndex r)
      : LinksOfRecord(grid, grid.point(r), grid.level(r)) {}

  /// Grid::destination() in direction q.
  RecordIndex destination(int q) const {
    if (!(links_.usable >> q & 1)) return Grid::kNoRecord;
    const auto target = static_cast<PointIndex>(p_ + grid_.neighbourhood_.offset(q));
    return links_.level[q] < grid_.levels(target) ? grid_.first(target) + links_.level[q]
                                                  : Grid::kNoRecord;
  }
  /// The same where the link straight back leads back to the record; else kNoRecord.
  RecordIndex two_way(int q) const {
    const RecordIndex to = destination(q);
    return to == Grid::kNoRecord || leads_back(to, q) ? to : Grid::kNoRecord;
  }
  /// Whether direction q leads to a record whose link straight back leads elsewhere.
  bool is_one_way(int q) const {
    const RecordIndex to = destination(q);
    return to != Grid::kNoRecord && !leads_back(to, q);
  }

 private:
  /// The link straight back leads to this point, whatever its level.
  bool leads_back(RecordIndex to, int q) const {
    return !is_tangled_ || grid_.links(to)[Direction(q).opposite().q()] == level_;
  }

  const Grid& grid_;
  PointIndex p_;
  Level level_;
  bool is_tangled_;
  const Links& links_;
};

inline bool Grid::is_one_way(RecordIndex r, int q) const {
  return LinksOfRecord(*this, r).is_one_way(q);
}

}  // namespace hapgrid
