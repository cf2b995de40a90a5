#include "libcore/base/json_text.hpp"

#include <nlohmann/json.hpp>

namespace hapgrid {

namespace {

std::string dump(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', /*ensure_ascii=*/true,
                   nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& json) { return dump(json, 2) + "\n"; }
std::string json_line(const nlohmann::ordered_json& json) { return dump(json, -1); }

}  // namespace hapgrid
