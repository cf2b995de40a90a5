// Force and energy of the HIP at the grid's points, as play has them there.
#pragma once

#include <utility>
#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/haptic/node_energies.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

/// Whether play can have a force of this grid at all.
/// @param model the grid's, or what its header says of it
bool has_force(const GridSpec& spec, const Model& model);

/// What the grid stores, or its model gives.
/// @param create makes the grid's model; called only where the grid does not store the force, in
/// the calling thread, once for each of `threads`. The result does not depend on `threads`.
/// @throw ModelError when no force can be had; what `create` throws.
RecordFields record_fields(const Grid& grid, const MakeModel& create, int threads);

/// The same, where records that have no force, and all have the same energy, share it.
RecordFields shared_fields(const Grid& grid, const MakeModel& create, int threads);

/// By record, in newtons.
class Forces {
 public:
  /// `forces`: as many as records.
  explicit Forces(std::vector<Vec3> forces) : forces_(std::move(forces)) {}

  const Vec3& operator[](RecordIndex r) const { return forces_[r]; }

 private:
  std::vector<Vec3> forces_;
};

}  // namespace hapgrid
