// How far two states are apart, in the unit of the tolerance.
//
// A declared tolerance function is a norm (grid/equality.hpp), which has a value. A plug-in only
// says whether two states are the same: a molecule's compares atoms, for example. We search for the
// largest λ such that the plug-in still calls a and a + λ (b - a) the same. Then the distance is
// tolerance / λ. For a norm this is exact; otherwise it is a good approximation near the tolerance.
#pragma once

#include <span>

#include "libcore/model/model.hpp"

namespace hapgrid {

/// Of finite states, or rows that begin with them. To one part in a million. Of a plug-in that
/// forgives nothing (tolerance 0): the largest difference of a component.
double state_distance(const Model& model, std::span<const double> a, std::span<const double> b);

}  // namespace hapgrid
