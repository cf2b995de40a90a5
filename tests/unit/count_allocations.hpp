// How often this executable allocated memory: operator new is replaced in count_allocations.cpp.
#pragma once

#include <cstdint>

#include "libcore/device/device.hpp"

namespace hapgrid::testing {

std::uint64_t allocations();
std::uint64_t allocations_of_thread();  // the calling one

/// How many of `ticks` reads and sends of a device come before one that fails; it is a failure,
/// too, if they allocate.
inline int ticks_without_allocating(Device& device, int ticks) {
  DeviceInput input;
  int done = 0;
  const std::uint64_t before = allocations_of_thread();
  while (done < ticks && device.read(input) == DeviceStatus::kOk &&
         device.send({1, 0, 0}) == DeviceStatus::kOk)
    ++done;
  return allocations_of_thread() == before ? done : -1;
}

}  // namespace hapgrid::testing
