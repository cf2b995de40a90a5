// How far records are from the seeds.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// The rows `reachable` and `generations`, from the records in ascending order.
class DistanceRows {
 public:
  static constexpr std::uint32_t kUnreached = ~std::uint32_t{0};

  /// @param box outlives this.
  explicit DistanceRows(const Box& box);

  /// @param distance from the seeds, in links
  void add(PointIndex point, Level level, std::uint32_t generation, std::uint32_t distance);
  /// @param generation of the grid
  std::vector<Check> finish(std::uint32_t generation);

 private:
  const Box& box_;
  Check reachable_, generations_;
  std::uint32_t youngest_ = 0, generation_before_ = 0;
};

/// `reachable`: links lead to each record from the records of generation 0 (the seeds), and
/// `generations`: a record's generation is the smallest number of links from there. Algorithm 1
/// stores in round g what it reached from the records of round g - 1, so a record of generation g
/// has a link from one of generation g - 1, and no link leads up by more than one generation.
/// Records that are not reachable are offenders of the first only.
std::vector<Check> check_reachable(const Grid& grid);

}  // namespace hapgrid
