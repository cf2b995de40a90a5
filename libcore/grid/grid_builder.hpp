// Makes a grid from runs of records, so that no second copy of all records is in memory.
#pragma once

#include <vector>

#include "libcore/base/mutex.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// A run of R records. Shapes as in RecordColumns.
struct RecordRun {
  std::span<const PointIndex> point;
  std::span<const Level> level;
  std::span<const std::uint32_t> generation;
  std::span<const double> rows;
  std::span<const Level> links;
};

/// The one rule for how many records a box has, before memory is taken for its points: a header can
/// claim any number of these in a few bytes. A grid of more than 2^24 points must have a record at
/// least at one in a thousand; a finished grid has one at each.
/// @throw FormatError when there are too few records, or too many for a RecordIndex
void require_possible(const Box& box, std::uint64_t records);

/// Checks what makes access to the grid safe (Grid).
class GridBuilder {
 public:
  /// @param generation the round that wrote the grid. @param records how many there will be.
  GridBuilder(GridSpec spec, std::uint32_t generation, std::uint64_t records);

  /// Sets the records from record `first` on. Runs come in any order, and several threads may add
  /// different runs at once. @throw FormatError when a run does not fit the grid.
  void add(std::uint64_t first, const RecordRun& run);
  /// The grid; this object is empty then.
  /// @throw FormatError when the records are not a grid's, or far too few.
  Grid finish();

 private:
  /// Sets the links of `count` records from record `first` on, whose points are set.
  void add_links(std::uint64_t first, std::size_t count, const Level* links);

  Grid grid_;
  std::vector<Level> level_;  // by record, to be checked
  std::uint64_t added_ = 0;   // records
  Mutex mutex_;               // of added_ and of the grid's table of links
};

}  // namespace hapgrid
