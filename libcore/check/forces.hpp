// The force on the HIP at the grid's points, as play has it there.
#pragma once

#include <vector>

#include "libcore/grid/grid.hpp"
#include "libcore/model/fields.hpp"

namespace hapgrid {

/// Whether play can have a force of this grid at all.
/// @param model the grid's, or what its header says of it
bool has_force(const GridSpec& spec, const Model& model);

/// By record, in newtons; one stored with the record, or evaluated by the grid's model.
class Forces {
 public:
  /// @param create makes the grid's model; called from the calling thread, only where no force is
  /// stored, once a thread.
  /// @throw ModelError when no force can be had.
  Forces(const Grid& grid, const MakeModel& create, int threads);
  /// `forces`: as many as records.
  explicit Forces(std::vector<Vec3> forces) : forces_(std::move(forces)) {}

  const Vec3& operator[](RecordIndex r) const { return forces_[r]; }

 private:
  std::vector<Vec3> forces_;
};

}  // namespace hapgrid
