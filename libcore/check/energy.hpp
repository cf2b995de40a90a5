// Whether a hand that comes back to where it was can have gained energy: closed walks along links.
//
// Work (work.hpp) says what a link gains, and what of this is allowed because nobody can know
// better. A closed walk that gains more than all its allowances together is a fault: the force's
// sign, links that are exchanged, or a force that is no gradient of an energy, also because the
// model cuts it. How much of it the hand feels is its *rate*: what it gains beyond its allowances,
// divided by its length, in newtons. It is as if a motor of that force pushed the hand along the
// walk.
//
// With the cost allowance + rate length - gain, no closed walk has more than this rate exactly when
// the graph has no negative cycle, that is, when there is a potential E with E_t <= E_r + cost for
// each link: the proof is such a potential, and looking at each link once checks it. A first one is
// integrated along reversible links; where that is not enough, Bellman-Ford's relaxation repairs
// it, or ends in a cycle, which is shown. The largest rate of all is found by its own cycles: each
// that is found raises the rate to its own, until none is left (Dinkelbach 1967 for ratios).
//
// What it does not show: gains below the allowances, which shrink with the spacing, and what
// happens where play mixes branches, where pairs of corners are no links (passive.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libcore/check/work.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

struct ClosedWalk {
  std::vector<Link> links;  ///< each leads to the next, the last to the first; empty: there is none
  double gain = 0;
  double allowance = 0;
  double length = 0;  ///< in the model's unit

  /// Newtons.
  double rate() const { return length > 0 ? (gain - allowance) / length : 0; }
};

/// What the links' work says of the whole grid.
struct Energy {
  /// By record, integrated along reversible links; a one-way link loses what it falls by more than
  /// it gains. Comparable within a part of the grid that reversible links connect.
  std::vector<double> potential;
  std::vector<std::uint32_t> part;  ///< by record
  ClosedWalk steepest;              ///< the closed walk with the largest rate, if it is above 0
  bool is_steepest = false;         ///< false: there may be a steeper one
  std::vector<ClosedWalk> gaining;  ///< closed walks with more than the rate that is tolerated
  bool gave_up = false;             ///< nothing is proved when none was found
};

/// @param most closed walks that are looked for
/// @param tolerated the rate that a closed walk may have, newtons
Energy find_energy(const Grid& grid, const Work& work, int threads, std::size_t most,
                   double tolerated = 0);

}  // namespace hapgrid
