// Proves that no closed walk of the hand returns energy.
//
// The grid is a directed graph: nodes are records, edges are links. Along a link r -> t of the
// shift d the force gives the hand the work (F_r + F_t)/2 · d, by the trapezoid rule, which is
// exact for a stored force, as play interpolates it along a cell's edge. Nobody knows the model's
// force between the points, so each link has a bound of what the rule may be off by:
//
//   there and back on one branch  half of the larger one of the second differences of F · d at the
//                                 link's two ends. The error is a twelfth of it where F is smooth,
//                                 and at most a quarter with one kink in the link (contact begins).
//                                 At the end of a branch or of the box only one of the two is
//                                 known: then the bound is all of it, and half of the change of
//                                 F · d along the link. With none known, it is half of |F · d| at
//                                 both ends.
//   one way                       the state jumps somewhere on the link: half of the jump of F · d,
//                                 and half of its change over the links before and after.
//
// A link can hold more than one kink or jump where the spacing barely resolves the field, so four
// times the bound is allowed (the hung ball at h = r/2 needs 0.9 of it, alanine dipeptide at 30
// points a side 3 to 4; a force of the wrong sign is found there with 8). A closed walk that gains
// more than all its allowances together is a fault: the force's sign, links that are exchanged, or
// a force that is no gradient of an energy, also because the model cuts it.
//
// With the cost allowance - gain there is no such walk exactly when the graph has no negative
// cycle, that is, when there is a potential E with E_t <= E_r - gain + allowance for each link: the
// proof is such a potential, and looking at each link once checks it. A first one is integrated
// along reversible links; where that is not enough, Bellman-Ford's relaxation repairs it, or ends
// in a cycle, which is shown.
//
// What it does not show: gains below the allowances, which shrink with the spacing, and what
// happens where play mixes branches, where pairs of corners are no links (passive.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libcore/check/forces.hpp"
#include "libcore/grid/grid.hpp"

namespace hapgrid {

struct Link {
  RecordIndex from;
  int q;
};

/// What the force gives the hand along links, in newtons times the model's unit of length.
class Work {
 public:
  /// Both must outlive this.
  Work(const Grid& grid, const Forces& forces) : grid_(grid), forces_(forces) {}

  /// By the trapezoid rule. The link must lead somewhere, as below.
  double gain(const Link& link) const;
  /// What the gain is off by, where the spacing resolves the field.
  double bound(const Link& link) const;
  /// What a link may gain too much.
  double allowance(const Link& link) const { return 4 * bound(link); }
  bool is_reversible(const Link& link) const;

 private:
  const Grid& grid_;
  const Forces& forces_;
};

struct ClosedWalk {
  std::vector<Link> links;  ///< each leads to the next, the last to the first
  double gain = 0;
  double allowance = 0;
};

/// What the links' work says of the whole grid.
struct Energy {
  /// By record, integrated along reversible links; a one-way link loses what it falls by more than
  /// it gains. Comparable within a part of the grid that reversible links connect.
  std::vector<double> potential;
  std::vector<std::uint32_t> part;  ///< by record
  std::vector<ClosedWalk> gaining;  ///< closed walks with gain > allowance
  bool gave_up = false;             ///< there may be more of them
};

/// @param most closed walks that are looked for
Energy find_energy(const Grid& grid, const Work& work, int threads, std::size_t most);

}  // namespace hapgrid
