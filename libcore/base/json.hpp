// JSON as others wrote it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

namespace hapgrid {

/// Nothing that hapgrid reads nests deeper than 5 levels. What is made of a parsed text, such as a
/// copy or a message, goes through its levels by recursion, and some 20,000 overflow the stack.
inline constexpr unsigned kMaxJsonDepth = 64;

/// Whether more than kMaxJsonDepth brackets are open anywhere in `json`, which need not be JSON.
bool nests_too_deep(std::string_view json);

/// As nlohmann::json::parse(), which is compiled in json.cpp alone: each source that compiles it
/// takes two seconds more.
/// @throw nlohmann::json::exception, also for a number that no double has, such as 1e999
nlohmann::json parse_json(std::string_view text);

}  // namespace hapgrid
