// Where an adapter says that the hand is.
#pragma once

#include "libcore/device/process_protocol.h"
#include "libcore/grid/vec3.hpp"

namespace hapgrid::testing {

inline Vec3 place(const hapgrid_device_state& state) {
  return {state.position[0], state.position[1], state.position[2]};
}

}  // namespace hapgrid::testing
