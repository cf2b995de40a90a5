#include "tools/play/table.hpp"

#include <cmath>
#include <sstream>

#include "libcore/base/error.hpp"
#include "libcore/base/text.hpp"
#include "libcore/base/toml.hpp"

namespace hapgrid {

namespace {

std::string word(const toml::node& node, const std::string& key) {
  if (node.is_string()) return **node.as_string();
  if (node.is_boolean()) return **node.as_boolean() ? "true" : "false";
  if (node.is_integer()) return std::to_string(**node.as_integer());
  if (node.is_floating_point()) {
    const double value = **node.as_floating_point();
    return std::isinf(value) ? (value > 0 ? "inf" : "-inf") : to_text(value);
  }
  throw Error("--config: play." + key + " must be a number, a text, true or false, or an array");
}

std::vector<CLI::ConfigItem> read_items(const toml::table& root) {
  std::vector<CLI::ConfigItem> items;
  const toml::node* play = root.get("play");
  if (!play) return items;
  if (!play->is_table()) throw Error("--config: play must be a table");
  for (const auto& [k, node] : *play->as_table()) {
    const std::string key(k.str());
    if (key == "config") throw Error("--config: play.config is no key");
    CLI::ConfigItem item;
    item.name = key;
    if (const toml::array* entries = node.as_array()) {
      for (const toml::node& entry : *entries) item.inputs.push_back(word(entry, key));
    } else {
      item.inputs.push_back(word(node, key));
    }
    items.push_back(item);
  }
  return items;
}

}  // namespace

std::vector<CLI::ConfigItem> PlayTable::from_config(std::istream& input) const {
  std::ostringstream text;
  text << input.rdbuf();
  try {
    return read_items(TomlFile(text.str(), "--config").root());
  } catch (const Error& e) {
    throw CLI::ConfigError(e.what(), CLI::ExitCodes::ConfigError);
  }
}

}  // namespace hapgrid
