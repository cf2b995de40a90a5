// What must hold of every grid that Algorithm 1 computed, whatever its model: conditions b) and c)
// of Sect. 2.2 as far as they can be seen without evaluating C again (that is fidelity.hpp).
//
// A check never stops at its first offender, and each looks at one thing only: a link that leads
// nowhere is an offender of `links`, and the other checks pass over it.
//
// `threads` is at least 1; no result depends on it.
#pragma once

#include <span>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/grid/state_distance.hpp"

namespace hapgrid {

/// `complete`: no record is left in the frontier.
Check check_complete(const Grid& grid, int threads);

/// `coverage`: each point of the box has a level.
Check check_coverage(const Grid& grid, int threads);

/// `links`: each direction that stays in the box leads to a level that exists, or is not settled
/// and the record is in the frontier; each direction that leaves the box is marked so.
Check check_links(const Grid& grid, int threads);

/// Whether each component is a finite number.
bool is_finite(std::span<const double> state);

/// `finite`: each component of each state is a finite number.
Check check_finite(const Grid& grid, int threads);

/// `distinct`: no two levels of a point are the same state under the tolerance function
/// (condition c), 1:1). Counts pairs; states that are not finite are left to `finite`.
Check check_distinct(const Grid& grid, const SameState& same);

/// `reachable`: links lead to each record from the records of generation 0 (the seeds), and
/// `generations`: a record's generation is the smallest number of links from there. Algorithm 1
/// stores in round g what it reached from the records of round g - 1, so a record of generation g
/// has a link from one of generation g - 1, and no link leads up by more than one generation.
/// Records that are not reachable are offenders of the first only.
std::vector<Check> check_reachable(const Grid& grid);

/// `blends`, a note and no fault: the cells in which the eight records that play takes from one
/// corner's destination levels are not linked with each other. Near a tear-off they belong to
/// different branches, and the interpolated state is one that the model never takes.
/// A cell is looked at with its lowest point. Source: design.md, section 7.6.
Check check_blends(const Grid& grid, int threads);

}  // namespace hapgrid
