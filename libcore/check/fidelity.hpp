// Condition b) of Sect. 2.2, tested with the model itself: the state at the destination of a link
// must be C(s, x, d). For a costly model, a repeatable sample of the records is tested.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/check/invariants.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// A sample of `count` records that are not in the frontier, ascending; all such records when there
/// are no more. It depends on the records, `count` and `seed`, and not on the platform.
std::vector<RecordIndex> sample_records(const Grid& grid, std::uint64_t count, std::uint64_t seed);

/// `stored`: evaluates force, energy and shape of `records` again and compares them with the stored
/// numbers. The arguments are those of check_fidelity().
Check check_stored(const Grid& grid, std::span<const RecordIndex> records,
                   const MakeModel& make_model, int threads);

/// How far a state is pushed, in tolerances: beyond what C may leave, and well within a basin.
/// States that are nearer to each other are hardly told apart.
inline constexpr double kPush = 10;

/// Where a state of rest at x goes when each component is pushed to one side, and where when it is
/// pushed to the other; empty where it comes back from one of them. The HIP makes the shortest of
/// steps and goes back, for C(s, x, 0) may be s without a look. A state that is not at rest, as on
/// the top of a barrier, falls away on both sides. One that is about to snap falls on one, and
/// where there is friction it stays where it was pushed to.
std::string falls_away(Model& model, const GridSpec& spec, std::span<const double> s,
                       const Vec3& x);

/// Up to this part of the states, a model may balance: where a probe stands on the axis of a linear
/// molecule, say, rounding does not push it off. A hand leaves such a place at once.
inline constexpr double kFew = 0.01;

/// `stable`: pushes the states of `records`, as falls_away() does. A note where they are few. The
/// arguments are those of check_fidelity().
Check check_stable(const Grid& grid, std::span<const RecordIndex> records,
                   const MakeModel& make_model, int threads);

/// `fidelity`: evaluates C in all settled directions of `records` and compares the state reached
/// with the stored state. Counts conversions. A conversion that fails is an offender, with the
/// message of the model. Directions without a destination are offenders of `links`, and states that
/// are not finite are offenders of `finite`; both are skipped here.
/// @param make_model is called once for each thread, by the calling thread.
/// @param threads at least 1; the result does not depend on it.
/// @param records_done counts the records that are done, for a progress line.
Check check_fidelity(const Grid& grid, std::span<const RecordIndex> records,
                     const MakeModel& make_model, int threads,
                     std::atomic<std::uint64_t>& records_done);

}  // namespace hapgrid
