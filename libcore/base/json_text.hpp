// JSON as hapgrid writes it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace hapgrid {

/// Indented by two blanks, with a line end behind it. What is no ASCII is escaped, and what is no
/// UTF-8, as a shard's strings may be, is replaced.
std::string json_text(const nlohmann::ordered_json& json);
/// The same in one line, without a line end.
std::string json_line(const nlohmann::ordered_json& json);

}  // namespace hapgrid
