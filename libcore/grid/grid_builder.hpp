// A grid from its records, in runs, so that nothing but the grid itself is ever whole in memory.
#pragma once

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// A run of R records. Shapes as in RecordColumns.
struct RecordRun {
  std::span<const PointIndex> point;
  std::span<const Level> level;
  std::span<const std::uint32_t> generation;
  std::span<const double> rows;
  std::span<const Level> links;
  std::span<const TearByte> tears;  ///< or empty
};

/// Checks what makes access to the grid safe (Grid).
class GridBuilder {
 public:
  /// @param generation the round that wrote the grid. @param expected as many records have memory
  /// at once.
  GridBuilder(GridSpec spec, std::uint32_t generation, bool has_tears, std::size_t expected = 0);

  /// Adds records, which come behind those before. @throw FormatError when they are not a grid's.
  void add(const RecordRun& run);
  /// The grid; this object is empty then. @throw FormatError when there are far too few records.
  Grid finish();

 private:
  void add_point(PointIndex point, Level level);

  Grid grid_;
  std::uint32_t levels_ = 0;  // of the last point
};

}  // namespace hapgrid
