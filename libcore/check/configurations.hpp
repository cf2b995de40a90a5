// All that play can be in: every configuration of the player, a cell with the levels of its eight
// corners, that any motion of the hand can lead to.
//
// Algorithm 2 is a finite machine: a cell switch looks at the levels of the corners and at the
// links of their records, at nothing else. So what the player can meet is found without sampling,
// by following the 26 switches from every configuration in which play can start (any cell, and each
// of its corners can be the one nearest to the HIP) until nothing new appears. A jump is split into
// single switches, and so is covered; the hand can take each of the 26 from everywhere in a cell,
// so nothing is found that could not happen.
//
// Most cells have one level at each corner and whole links there: they have one configuration, and
// whatever leads there leads to it. They are not listed. The others are kept in sets by shard, each
// owned by one thread at a time: the rounds of the search exchange candidates, not locks.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "libcore/base/parallel.hpp"
#include "libcore/grid/cell.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

struct Configuration {
  PointIndex base = 0;       ///< names the cell: the point of its corner (0,0,0)
  std::uint64_t levels = 0;  ///< byte c is the level in corner c = i + 2j + 4k
  auto operator<=>(const Configuration&) const = default;
};

/// The corners of a configuration, whose levels must exist.
Corners corners_of(const Grid& grid, const Cells& cells, const Configuration& configuration);
Configuration configuration_of(PointIndex base, const Corners& corners);

/// Two corners of a cell that are different grid points, and the direction from one to the other.
struct CornerPair {
  int a, b;
  int q;
};
/// All pairs, in both orders.
std::vector<CornerPair> corner_pairs(const Cells& cells);

/// Whether a corner has a link to another level of another corner's point than is there (design.md,
/// section 7.6).
/// @param pairs corner_pairs() of the grid's cells
bool is_mixed(const Grid& grid, const std::vector<CornerPair>& pairs, const Corners& corners);

/// What cells there are, and which can have more than one configuration.
class CellMap {
 public:
  /// @param threads at least 1
  CellMap(const Grid& grid, int threads);

  bool exists(PointIndex base) const { return kind_[base] != kNone; }
  /// Whether the cell has one configuration: one level in each corner, and links from there to
  /// levels that exist in all directions that stay in the box.
  bool is_simple(PointIndex base) const { return kind_[base] == kSimple; }
  /// The moves to cells that exist.
  DirectionMask moves(PointIndex base) const { return around_.inside(coordinates(base)); }
  /// The cell's own (i, j, k).
  GridCoordinates coordinates(PointIndex base) const { return box_.coordinates(base); }
  std::uint64_t cells() const { return cells_; }
  std::uint64_t simple() const { return simple_; }

 private:
  enum Kind : std::uint8_t { kNone, kSimple, kListed };
  Box box_;
  Neighbourhood around_;            // of cells
  std::vector<std::uint8_t> kind_;  // by base, a Kind
  std::uint64_t cells_ = 0;
  std::uint64_t simple_ = 0;
};

struct Configurations {
  /// Those of the cells that are not simple, ascending.
  std::vector<Configuration> listed;
  /// The search was given up with more of them than this many, which are not looked at.
  bool gave_up = false;
};

/// The most configurations that are looked for: some hundred bytes for each cell of the grid, where
/// real ones have little more than one.
std::uint64_t default_configuration_limit(const CellMap& map);

/// @param threads at least 1; the result does not depend on it.
Configurations find_configurations(const Grid& grid, const CellMap& map, int threads,
                                   std::uint64_t limit);

/// Calls cell(base, seen) for each point and listed(configuration, seen) for each listed
/// configuration, in threads, and joins what they have seen in this order.
template <class Seen, class Cell, class Listed>
Seen look_at_all(const Grid& grid, const Configurations& found, int threads, const Cell& cell,
                 const Listed& listed) {
  constexpr std::uint64_t kBlock = 1 << 12;
  const auto of = [](const auto& look_at) {
    return [&look_at](std::uint64_t begin, std::uint64_t end) {
      Seen seen;
      for (std::uint64_t i = begin; i < end; ++i) look_at(i, seen);
      return seen;
    };
  };
  const auto look_at_cell = [&](std::uint64_t p, Seen& seen) {
    cell(static_cast<PointIndex>(p), seen);
  };
  const auto look_at_listed = [&](std::uint64_t i, Seen& seen) { listed(found.listed[i], seen); };
  Seen seen = sum_of_blocks<Seen>(grid.box().points(), kBlock, threads, of(look_at_cell));
  seen.add(sum_of_blocks<Seen>(found.listed.size(), kBlock, threads, of(look_at_listed)));
  return seen;
}

}  // namespace hapgrid
