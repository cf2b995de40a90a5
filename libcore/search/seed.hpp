// The seed records: lines 1 to 8 of Algorithm 1, without their expansion.
#pragma once

#include "libcore/model/definition.hpp"
#include "libcore/model/model.hpp"
#include "libcore/shard/writer.hpp"

namespace hapgrid {

/// The description of the grid that `definition` asks for with this model.
/// @throw Error when d_max < sqrt(3) h (Sect. 2.2, condition a).
GridSpec describe_grid(const Definition& definition, const Model& model);

/// Writes the seed records, all of them frontier, and finishes `out`.
/// @throw Error when a seed lies outside the box or on no grid point, is given twice, or a state
/// has another size than the model's, is not finite, or equals another one of its point; or when
/// the model knows no state at a seed.
void write_seeds(const Definition& definition, const GridSpec& spec, const Model& model,
                 SectionWriter& out);

}  // namespace hapgrid
