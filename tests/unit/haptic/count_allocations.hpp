// How often this executable allocated memory: operator new is replaced in count_allocations.cpp.
#pragma once

#include <cstdint>

namespace hapgrid::testing {

std::uint64_t allocations();
std::uint64_t allocations_of_thread();  // the calling one

}  // namespace hapgrid::testing
