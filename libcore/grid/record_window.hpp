// Records that come in order, and at each point all that its links lead to: for what looks at a
// grid without having it. The window has two layers of the box and a row, whatever its height.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/grid/record_order.hpp"

namespace hapgrid {

/// Neighbourhood::inside() of points that mostly ascend one by one: within a row of the box it
/// stays the same.
class InsideOfRun {
 public:
  /// Both outlive this.
  InsideOfRun(const Box& box, const Neighbourhood& around) : box_(box), around_(around) {}

  DirectionMask operator()(PointIndex p) {
    if (is_same(p)) return mask_;
    const GridCoordinates c = box_.coordinates(p);
    mask_ = around_.inside(c);
    begin_ = p;
    size_ = c[0] > 0 && c[0] + 1 < box_.counts[0] ? box_.counts[0] - 1 - c[0] : 1;
    return mask_;
  }
  /// Whether p, not before the last point, has the same.
  bool is_same(PointIndex p) const { return p - begin_ < size_; }

 private:
  const Box& box_;
  const Neighbourhood& around_;
  DirectionMask mask_ = 0;
  PointIndex begin_ = 0;
  std::uint32_t size_ = 0;  // so many points from here on have the same
};

class RecordWindow {
 public:
  struct Record {
    std::uint32_t links = 0;  // their number in the table
    std::uint32_t generation = 0;
  };

  /// @param spec outlives this.
  explicit RecordWindow(const GridSpec& spec);

  /// Adds a record. Before, calls look(p) for points around which everything has come: all points
  /// of the box in ascending order, also those without records, the last of them by finish().
  /// @throw FormatError when the records are not a grid's.
  template <class Look>
  void add(PointIndex p, Level level, std::uint32_t generation, const Level* links, Look&& look) {
    order_.next(records_, p, level);
    if (level == 0)
      while (opened_ <= p) {
        open();
        look_behind(look);
      }
    append(p, level, generation, links);
  }
  template <class Look>
  void finish(Look&& look) {
    while (opened_ < points_ + reach_ + 1) {
      open();
      look_behind(look);
    }
  }

  RecordIndex records() const { return records_; }

  // At a point that is looked at, and its neighbours.

  RecordIndex levels(std::uint64_t p) const { return at(p).levels; }
  const Record& record(std::uint64_t p, Level level) const {
    return kept_[at(p).first + level - dropped_];
  }
  const Links& links(std::uint64_t p, Level level) const { return table_[record(p, level).links]; }
  /// Whether a point whose directions all stay in the box, and its 26 neighbours, have one level
  /// each, and links that lead to level 0.
  bool is_plain(std::uint64_t p) const {
    for (const std::int64_t row : rows_)
      if (at(p + static_cast<std::uint64_t>(row) + 1).run < 3) return false;
    return true;
  }

 private:
  struct Entry {
    RecordIndex first = 0;
    std::uint16_t levels = 0;
    std::uint16_t run = 0;  // so many points up to this one are plain: 3 at most
  };

  Entry& at(std::uint64_t p) { return entries_[p & mask_]; }
  const Entry& at(std::uint64_t p) const { return entries_[p & mask_]; }
  void open();
  void append(PointIndex p, Level level, std::uint32_t generation, const Level* links);
  template <class Look>
  void look_behind(Look&& look) {
    // The point that was opened last is not complete.
    if (opened_ < looked_at_ + reach_ + 2) return;
    if (looked_at_ < points_) look(static_cast<PointIndex>(looked_at_));
    ++looked_at_;
    const RecordIndex needed = looked_at_ > reach_ ? at(looked_at_ - reach_).first : 0;
    for (; dropped_ < needed; ++dropped_) kept_.pop_front();
  }

  const Neighbourhood around_;
  std::uint64_t points_, reach_;
  std::array<std::int64_t, 9> rows_{};  // to the rows around, as point indices
  RecordOrder order_;
  InsideOfRun inside_of_;
  LinkTable table_;
  std::vector<Entry> entries_;  // a ring
  std::uint64_t mask_ = 0;
  std::deque<Record> kept_;
  RecordIndex records_ = 0, dropped_ = 0;
  std::uint64_t opened_ = 0, looked_at_ = 0;  // points
  std::array<Level, kDirections> links_before_{};
  DirectionMask inside_before_ = 0;
  std::uint32_t number_before_ = 0;
};

}  // namespace hapgrid
