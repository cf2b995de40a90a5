// What must hold of every grid that Algorithm 1 computed, whatever its model: conditions a), b) and
// c) of Sect. 2.2 as far as they can be seen without evaluating C again (that is fidelity.hpp).
//
// Each function is a row of the report. A check never stops at its first offender, and each looks
// at one thing only: a link that leads nowhere is an offender of `links`, and the other checks pass
// over it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/follow/branch_nodes.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// Whether each component is a finite number.
bool is_finite(std::span<const double> state);

/// `complete`: no record is left in the frontier.
Check check_complete(const Grid& grid);

/// `coverage`: each point of the box has a level.
Check check_coverage(const Grid& grid);

/// `links`: each direction that stays in the box leads to a level that exists, or is not settled
/// and the record is in the frontier; each direction that leaves the box is marked so.
Check check_links(const Grid& grid);

/// `finite`: each number of each row is finite.
Check check_finite(const Grid& grid);

/// `distinct`: no two levels of a point are the same state under the tolerance function (condition
/// c), 1:1). Counts pairs; states that are not finite are left to `finite`.
Check check_distinct(const Grid& grid, const Model& model);

/// By record: the smallest number of links that lead to it from the records of generation 0 (the
/// seeds); kUnreached where none do.
std::vector<std::uint32_t> find_distances(const Grid& grid);
inline constexpr std::uint32_t kUnreached = ~std::uint32_t{0};

/// `reachable`: links lead from the seeds to each record.
/// @param distances find_distances() of the grid
Check check_reachable(const Grid& grid, const std::vector<std::uint32_t>& distances);

/// `generations`: a record's generation is its distance from the seeds. Algorithm 1 stores in round
/// g what it reached from the records of round g - 1. The levels of a point ascend with their
/// generation, for play starts at level 0. Records that are not reachable are offenders of
/// `reachable` only.
/// @param distances find_distances() of the grid
Check check_generations(const Grid& grid, const std::vector<std::uint32_t>& distances);

// Whether the state jumps while the hand moves.

/// `continuous`: in every cell around every record, the branch of this record has a node in all
/// corners. The rule that stays on a branch (follow/branch_traversal.hpp) then always has a state
/// to go on with, and this state jumps nowhere but at a snap. Counts the cells around all records.
/// Figures: in how many of them a branch ends (`torn`), how many are `mixed`
/// (BranchNodes::is_mixed()), and how many `ghosts` there are.
Check check_continuous(const Grid& grid, const BranchNodes& branches);

/// Refuses a grid that cannot be played as a whole, and says what to do about it.
/// @param name of the grid, for messages.
/// @throw Error when a check of `complete`, `coverage`, `links` or `finite` has an offender
void require_playable(const Grid& grid, const std::string& name);

}  // namespace hapgrid
