// A grid from its records, in runs, so that nothing but the grid itself is ever whole in memory.
#pragma once

#include <mutex>
#include <vector>

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
  /// @param generation the round that wrote the grid. @param records how many there will be.
  /// @param generations may be left out where there is no frontier.
  GridBuilder(GridSpec spec, std::uint32_t generation, bool has_tears, std::uint64_t records,
              Generations generations = Generations::kKept);

  /// Adds the records from record `first` on. Runs come in any order, and several threads may add
  /// runs at once. @throw FormatError when they are not a grid's.
  void add(std::uint64_t first, const RecordRun& run);
  /// The grid; this object is empty then.
  /// @throw FormatError when the runs do not make a grid, or when there are far too few records.
  Grid finish();

 private:
  /// What is known of a run that was added.
  struct Run {
    std::uint64_t first = 0, size = 0;
    PointIndex first_point = 0, last_point = 0;
    Level first_level = 0, last_level = 0;
    std::vector<PointIndex>
        points{};  // empty where no point between the first and last is left out
  };

  void require_shapes(std::uint64_t first, const RecordRun& run) const;
  Run check_order(std::uint64_t first, const RecordRun& run);
  void mark_upper(std::uint64_t first, std::span<const Level> level);
  void add_links(std::uint64_t first, const RecordRun& run);
  std::uint32_t number_of(const Links& links);
  void join_runs();
  std::vector<PointIndex> points_of_records();

  Grid grid_;
  std::uint64_t records_;
  std::vector<std::uint64_t> is_upper_;  // by record, a bit: whether its level is above 0
  std::once_flag shared_;
  std::mutex links_mutex_, table_mutex_, rows_mutex_, runs_mutex_;
  std::vector<Run> runs_;
};

}  // namespace hapgrid
