// A line of a model process, taken apart.
#pragma once

#include <string>

#include "libcore/model/protocol.hpp"

namespace hapgrid::testing {

inline Answer answer(const std::string& line) { return read_answer(line); }

}  // namespace hapgrid::testing
