// What must hold of every grid that Algorithm 1 computed, whatever its model: conditions b) and c)
// of Sect. 2.2 as far as they can be seen without evaluating C again (that is fidelity.hpp).
//
// The records come in order, once, and no more of the grid than two layers is kept. Only where a
// generation or a link between generations is wrong, the whole grid is needed to say which records
// are not reachable.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/grid/state_distance.hpp"
#include "libcore/shard/section.hpp"

namespace hapgrid {

/// Whether each component is a finite number.
bool is_finite(std::span<const double> state);

/// The rows, in this order. A check never stops at its first offender, and each looks at one thing
/// only: a link that leads nowhere is an offender of `links`, and the other checks pass over it.
/// - `complete`: no record is left in the frontier.
/// - `coverage`: each point of the box has a level.
/// - `links`: each direction that stays in the box leads to a level that exists, or is not settled
///   and the record is in the frontier; each direction that leaves the box is marked so.
/// - `finite`: each number of each row is finite.
/// - `distinct`: no two levels of a point are the same state under the tolerance function
///   (condition c), 1:1). Counts pairs; states that are not finite are left to `finite`.
/// - `fractions`, of a grid that has tear fractions: each one-way link has one, and no other
///   direction has.
/// - `reachable` and `generations` (reachable.hpp).
std::vector<Check> check_invariants(const Grid& grid, const SameState& same);
/// Of a section that is a grid. @throw as load_grid()
std::vector<Check> check_invariants(const Section& section, const SameState& same);

}  // namespace hapgrid
