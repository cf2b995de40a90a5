// What is looked at before a JSON text that others wrote is given to the parser.
#pragma once

#include <string_view>

namespace hapgrid {

/// Nothing that hapgrid reads nests deeper than 5 levels. What is made of a parsed text, such as a
/// copy or a message, goes through its levels by recursion, and some 20,000 overflow the stack.
inline constexpr unsigned kMaxJsonDepth = 64;

/// Whether more than kMaxJsonDepth brackets are open anywhere in `json`, which need not be JSON.
bool nests_too_deep(std::string_view json);

}  // namespace hapgrid
