// How often this executable allocated memory: operator new is replaced in count_allocations.cpp.
#pragma once

#include <cstdint>

namespace hapgrid::testing {

std::uint64_t allocations();

}  // namespace hapgrid::testing
