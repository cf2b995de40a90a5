// A line of a model process, taken apart.
#pragma once

#include <string>

#include "libcore/model/protocol.hpp"

namespace hapgrid::testing {

inline Answer answer(const std::string& line) {
  Answer a;
  read_answer(line, a);
  return a;
}

}  // namespace hapgrid::testing
