// Are the snaps the model's own, or jumps of a minimiser over a barrier that is still there?
//
// A minimiser whose first step is long can end behind a barrier that is still there. C is then
// deterministic, agrees with itself, and passes every check that asks it again: but its snaps come
// too early, at places that depend on the steps that C makes. The same way in many short pieces
// tells: the HIP moves so little in each that there is nothing to leap over. Random steps tell
// nothing, because most of them meet no barrier. So the steps along which the model snaps are
// walked, and few of an honest model's end elsewhere: those that meet a fork.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "libcore/check/report.hpp"
#include "libcore/grid/grid.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

inline constexpr int kPieces = 64;

/// C from s at x by d, in kPieces equal steps, into `row`. Answers whether the model has made all
/// of them; model.error() says why not. No answer when it is late before one of them.
std::optional<bool> convert_in_pieces(Model& model, std::span<const double> s, const Vec3& x,
                                      const Vec3& d, std::vector<double>& row,
                                      const std::function<bool()>& is_late = {});

/// Finishes the row `snaps`, whose findings are steps along which the model snaps, and those that
/// end elsewhere in pieces: a note while these are a tenth or fewer, or two, else a fault.
void judge_snaps(Check& check);

/// Finishes the row `halves`, whose findings are steps, and those that end in another state when
/// they are made in two halves: a note while these are few, as near a tear-off, else a fault.
/// @param apart how far these states are apart, in the unit of the tolerance
void judge_halves(Check& check, std::vector<double> apart, const GridSpec& spec);

/// How exact C is: the spread of states that count as the same, beside the tolerance.
/// @param distances of such states, in the unit of the tolerance
Figure exactness(std::vector<double> distances, const GridSpec& spec);

/// `snaps`: walks one-way links of the grid in pieces, at most 256 of them and two for each of
/// `records`, evenly chosen. Links that C does not follow are offenders of `fidelity`. Its figure
/// is the distance of a state that C gives, evaluated again along one two-way link of each record,
/// from the state that is stored there.
/// @param make_model is called once for each thread, by the calling thread.
Check check_snaps(const Grid& grid, std::span<const RecordIndex> records,
                  const MakeModel& make_model, int threads);

}  // namespace hapgrid
