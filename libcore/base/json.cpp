#include "libcore/base/json.hpp"

#include <nlohmann/json.hpp>

namespace hapgrid {

bool nests_too_deep(std::string_view json) {
  unsigned depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text) {
      if (c == '\\') ++i;  // whatever follows is not the end of the text
      in_text = c != '"';
    } else if (c == '"') {
      in_text = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxJsonDepth) return true;
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return false;
}

nlohmann::json parse_json(std::string_view text) { return nlohmann::json::parse(text); }

namespace {

std::string dump(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', /*ensure_ascii=*/true,
                   nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& json) { return dump(json, 2) + "\n"; }
std::string json_line(const nlohmann::ordered_json& json) { return dump(json, -1); }

}  // namespace hapgrid
