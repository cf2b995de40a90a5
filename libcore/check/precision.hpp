// What is left of the checks where a grid's numbers may be off by a recorded bound (`merge --final
// --precision`). A check forgives what the bound can explain: it cannot know the model's numbers.
#pragma once

#include "libcore/check/fidelity.hpp"
#include "libcore/check/invariants.hpp"
#include "libcore/check/report.hpp"
#include "libcore/shard/load.hpp"

namespace hapgrid {

/// For `fidelity`: functions whose `same`, asked after convert(), holds
/// - when the state reached is the same as one that is not further from the state stored than twice
///   the bounds: once for the state stored, and once for the state that the conversion started
///   from, as a conversion within one branch of states does not amplify an error; or
/// - when that is so from a start that is moved by the bounds, one component or all: next to a
///   tear-off the smallest change decides on which branch a conversion ends.
/// One conversion at a time, of a model process too.
ModelFunctions forgiving(ModelFunctions model, const LoadedGrid& loaded);

/// For `distinct`: whether `same` holds however far the bounds may have moved the two states
/// towards each other.
SameState same_in_spite_of(SameState same, const LoadedGrid& loaded);

/// `precision`, without the original: no column's bound is more than the recorded precision allows
/// for the range of the column's own numbers. Counts columns that have a bound.
Check check_precision(const LoadedGrid& loaded);

/// `precision`, with the grid that was coded: the same records, generations and destination levels,
/// and each number within its bound; bit by bit where it has none. Counts numbers.
/// @throw Error when `original` is another grid, or may be off itself.
Check check_precision(const LoadedGrid& loaded, const LoadedGrid& original);

}  // namespace hapgrid
