// JSON as others wrote it, and as hapgrid writes it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace hapgrid {

/// Nothing that hapgrid reads nests deeper than 5 levels. What is made of a parsed text, such as a
/// copy or a message, goes through its levels by recursion, and some 20,000 overflow the stack.
inline constexpr unsigned kMaxJsonDepth = 64;

/// Whether more than kMaxJsonDepth brackets are open anywhere in `json`, which need not be JSON.
bool nests_too_deep(std::string_view json);

/// As nlohmann::json::parse(), which takes long to compile, and so is compiled in json.cpp alone.
/// @throw nlohmann::json::exception, also for a number that no double has, such as 1e999
nlohmann::json parse_json(std::string_view text);

/// Indented by two blanks, with a line end behind it. What is no ASCII is escaped, and what is no
/// UTF-8, as a shard's strings may be, is replaced.
std::string json_text(const nlohmann::ordered_json& json);
/// The same in one line, without a line end.
std::string json_line(const nlohmann::ordered_json& json);

}  // namespace hapgrid
