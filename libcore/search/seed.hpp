// The seed records: lines 1 to 8 of Algorithm 1, without their expansion.
#pragma once

#include <map>
#include <vector>

#include "libcore/model/definition.hpp"
#include "libcore/model/model.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// The description of the grid that `definition` asks for with this model.
/// @throw Error when d_max < sqrt(3) h (Sect. 2.2, condition a).
GridSpec spec_of(const Definition& definition, const Model& model);

/// By point the states that are known there, row after row.
using Seeds = std::map<PointIndex, std::vector<double>>;

/// The states at the seed points of a definition; its box must be the grid's.
/// @throw Error when a seed lies outside the box or on no grid point, is given twice, has a state
/// of another size than the model's, or when the model knows no state there.
Seeds seed_states(const Definition& definition, Model& model);

/// Writes the seed records, all of them frontier, and finishes `out`.
/// @throw Error as seed_states(), and when a state is not finite or equals another one of its
/// point.
void write_seeds(const Definition& definition, const GridSpec& spec, Model& model,
                 SectionWriter& out);

}  // namespace hapgrid
