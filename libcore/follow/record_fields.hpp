// Force and energy at a grid's records, as play interpolates them.
#pragma once

#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

/// By record.
struct RecordFields {
  std::vector<Vec3> force;     ///< newtons
  std::vector<double> energy;  ///< newtons times the unit of length; empty where it is not known
};

/// The grid's stored values, or else the model's.
/// @param create makes the grid's model; called only where the grid does not store the force, in
/// the calling thread, once for each of `threads`. The result does not depend on `threads`.
/// @throw ModelError when no force can be had; what `create` throws.
RecordFields record_fields(const Grid& grid, const MakeModel& create, int threads);

}  // namespace hapgrid
