// A box in the messages of all streams (Box of schemas/common.capnp). Builder and Reader are Cap'n
// Proto's, which only the folders with streams include.
#pragma once

#include "libcore/grid/box.hpp"

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

/// Not checked yet: see Box::validate().
template <class Reader>
Box get_box(Reader in) {
  return {{in.getOriginX(), in.getOriginY(), in.getOriginZ()},
          in.getSpacing(),
          {in.getCountX(), in.getCountY(), in.getCountZ()}};
}

}  // namespace hapgrid
