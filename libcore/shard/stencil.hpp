// From which records of its chunk a record's numbers are predicted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/grid/grid.hpp"

namespace hapgrid {

/// The way back from each of the R records of one chunk along one axis.
///
/// The neighbour is the record where the link in direction -i, -j or -k leads, not the one of the
/// same level: levels are numbered as they are discovered, so that near a tear-off the same branch
/// of states has another level at the next point.
struct BackwardAxis {
  static constexpr std::uint8_t kMaxDepth = 3;

  std::vector<std::uint32_t> back;  ///< the row one point back; any where depth is 0
  std::vector<std::uint8_t> depth;  ///< how often one can go back, kMaxDepth at most
};

/// Along k the way leads through all rows. Along j only through rows of the same depth along k, and
/// along i through rows of the same depths along j and k: only there the differences that are
/// extrapolated are of the same kind (prediction.hpp).
struct Stencil {
  std::array<BackwardAxis, 3> axes;     ///< i, j, k
  std::vector<std::uint32_t> fallback;  ///< a row nearby where no way leads back; of row 0: 0
  /// How many rows one step back is at most, along i, j, k.
  std::array<std::uint32_t, 3> farthest{};

  std::size_t rows() const { return fallback.size(); }

  /// Shapes: R points (ascending), levels, R x 26 links, of a box with `counts` points. Nothing of
  /// what they hold is trusted,
  /// except that the points ascend and span fewer than 2^28.
  void find(std::span<const PointIndex> point, std::span<const Level> level,
            std::span<const Level> links, const GridCoordinates& counts);

 private:
  std::vector<std::uint32_t> first_;  // row of each point between the first and the last
};

}  // namespace hapgrid
