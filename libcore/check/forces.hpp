// The forces at a grid's records, by which checks tell what a hand feels.
#pragma once

#include <utility>
#include <vector>

#include "libcore/haptic/record_fields.hpp"

namespace hapgrid {

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
