// A box and a sphere in the messages of all streams (schemas/common.capnp). Builder and Reader are
// Cap'n Proto's, which only the folders with streams include.
#pragma once

#include <cmath>

#include "libcore/base/error.hpp"
#include "libcore/grid/box.hpp"
#include "libcore/grid/spec.hpp"

namespace hapgrid {

template <class Builder>
void set_box(Builder out, const Box& box) {
  out.setOriginX(box.origin[0]);
  out.setOriginY(box.origin[1]);
  out.setOriginZ(box.origin[2]);
  out.setSpacing(box.spacing);
  out.setCountX(box.counts[0]);
  out.setCountY(box.counts[1]);
  out.setCountZ(box.counts[2]);
}

/// @throw FormatError for an impossible box (Box::validate()).
template <class Reader>
Box get_box(Reader in) {
  const Box box{{in.getOriginX(), in.getOriginY(), in.getOriginZ()},
                in.getSpacing(),
                {in.getCountX(), in.getCountY(), in.getCountZ()}};
  try {
    box.validate();
  } catch (const Error& e) {
    throw FormatError(e.what());
  }
  return box;
}

/// All but the label: shards have one of each sphere, frames only those that are not empty.
template <class Builder>
void set_sphere(Builder out, const Sphere& sphere) {
  out.setRadius(sphere.radius);
  out.setRed(sphere.colour[0]);
  out.setGreen(sphere.colour[1]);
  out.setBlue(sphere.colour[2]);
}

/// @throw FormatError when it cannot be
template <class Reader>
Sphere get_sphere(Reader in) {
  const Sphere sphere{in.getRadius(), {in.getRed(), in.getGreen(), in.getBlue()}, in.getLabel()};
  const auto& [red, green, blue] = sphere.colour;
  if (!std::isfinite(red + green + blue) || !(sphere.radius >= 0) ||
      !std::isfinite(sphere.radius) || sphere.label.size() > kMaxLabelSize)
    throw FormatError("a sphere whose radius, colour or label is impossible");
  return sphere;
}

}  // namespace hapgrid
