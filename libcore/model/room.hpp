// How large a box must be for a model to have room in it, by the model's shape and the HIP's ball.
#pragma once

#include <optional>
#include <string>

#include "libcore/grid/box.hpp"
#include "libcore/model/model.hpp"

namespace hapgrid {

struct Extent3 {
  Vec3 low, high;
};

/// From where to where the spheres of a state are, with the HIP's ball around them; nothing where
/// the model has no shape.
/// @param x where the HIP is
std::optional<Extent3> extent_with_probe(Model& model, const Vec3& x, const double* state);

/// Where the model knows no state in a corner of the box: that the box is too small and which one
/// would do, for the end of a message; empty if no larger one around the same middle does.
std::string larger_box(Model& model, const Box& box);

/// "from (0, 0, 0) to (1, 1, 1)"
std::string extent_text(const Extent3& extent);

}  // namespace hapgrid
