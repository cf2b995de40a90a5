// Condition b) of Sect. 2.2, tested on the model itself: the state that is stored where a link
// leads must be C(s, x, d). For a costly model a repeatable sample of the records has to do.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "libcore/check/invariants.hpp"
#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

/// `count` of the records that are not in the frontier, ascending; all of them when there are no
/// more. Depends on the grid's records, `count` and `seed` only, not on the platform.
std::vector<RecordIndex> sample_records(const Grid& grid, std::uint64_t count, std::uint64_t seed);

/// `stored`: evaluates force, energy and shape of `records` again and compares them with what is
/// stored. Arguments as below.
Check check_stored(const Grid& grid, std::span<const RecordIndex> records,
                   const MakeModel& make_model, int threads);

/// `fidelity`: evaluates C in all settled directions of `records` and compares what it reaches
/// with what is stored there. Counts conversions; one that fails is an offender with the model's
/// own words. Directions that lead nowhere are left to `links`, and states that are not
/// finite, here or there, to `finite`.
/// @param make_model is called once a thread, from the calling thread.
/// @param threads at least 1; the result does not depend on it.
/// @param records_done counts up meanwhile, for whoever shows it.
Check check_fidelity(const Grid& grid, std::span<const RecordIndex> records,
                     const MakeModel& make_model, int threads,
                     std::atomic<std::uint64_t>& records_done);

}  // namespace hapgrid
