// What a refusal says.
#pragma once

#include <string>

#include "libcore/base/error.hpp"

namespace hapgrid::testing {

/// The message of the hapgrid::Error that `f` throws, or "" where it throws none.
template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace hapgrid::testing
