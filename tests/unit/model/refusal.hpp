// What the tests of models share.
#pragma once

#include <string>

#include "libcore/base/error.hpp"
#include "libcore/model/protocol.hpp"

namespace hapgrid::testing {

/// What the ModelError says that `f` throws.
template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const ModelError& e) {
    return e.what();
  }
  return "(nothing was refused)";
}

inline Answer answer(const std::string& line) { return read_answer(line); }

}  // namespace hapgrid::testing
