// The one source that compiles the parser of toml++.
#define TOML_IMPLEMENTATION
#include "libcore/base/toml.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {

// Beyond this a whole number has no exact double.
constexpr std::int64_t kExact = std::int64_t{1} << 53;

// toml++ limits how deep values nest but not how many parts a dotted key has, and goes through them
// by recursion: a key of a megabyte of dots would overflow the stack.
constexpr unsigned kMaxKeyParts = 1000;

/// The line of a key with too many parts, 0 when there is none. Takes any 1000 dots without a
/// comma, bracket or equals sign between them for one.
std::uint64_t overlong_key(const std::string& text) {
  std::uint64_t line = 1;
  unsigned dots = 0;
  for (const char c : text) {
    if (c == '.' && ++dots >= kMaxKeyParts) return line;
    if (std::strchr(",=[]{}\n", c)) dots = 0;
    line += c == '\n';
  }
  return 0;
}

}  // namespace

TomlFile::TomlFile(const std::string& text, std::string name) : name_(std::move(name)) {
  if (const std::uint64_t line = overlong_key(text))
    fail(line, format("a key of more than {} parts", kMaxKeyParts));
  try {
    root_ = toml::parse(text, std::string_view());
  } catch (const toml::parse_error& e) {
    fail(e.source().begin.line, std::string(e.description()));
  } catch (const Error& e) {
    fail(0, e.what());
  }
}

void TomlFile::fail(std::uint64_t line, const std::string& what) const {
  // Nodes that an override made have no place in the file.
  throw Error(line ? format("{}: line {}: {}", name_, line, what) : format("{}: {}", name_, what));
}

void TomlFile::fail(const toml::node& node, const std::string& what) const {
  fail(node.source().begin.line, what);
}

void TomlFile::only_keys(const toml::table& table, const std::string& prefix,
                         std::initializer_list<std::string_view> known) const {
  for (const auto& [key, value] : table) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    std::string names;
    for (const std::string_view k : known) names += (names.empty() ? "" : ", ") + std::string(k);
    fail(key.source().begin.line, format("unknown key {}{} (known: {})", prefix, key.str(), names));
  }
}

const toml::table& TomlFile::table(const toml::table& in, const std::string& key) const {
  const toml::node* node = in.get(key);
  if (!node) fail(0, format("the table [{}] is missing", key));
  if (!node->is_table()) fail(*node, format("{} must be a table", key));
  return *node->as_table();
}

const toml::node& TomlFile::required(const toml::table& in, const std::string& prefix,
                                     const char* key) const {
  const toml::node* node = in.get(key);
  if (!node) fail(in, format("the key {}{} is missing", prefix, key));
  return *node;
}

std::string TomlFile::text(const toml::node& node, const std::string& key) const {
  if (!node.is_string()) fail(node, format("{} must be a text in quotes", key));
  return **node.as_string();
}

const toml::array& TomlFile::array(const toml::node& node, const std::string& key) const {
  if (!node.is_array()) fail(node, format("{} must be an array", key));
  return *node.as_array();
}

bool TomlFile::boolean(const toml::node& node, const std::string& key) const {
  if (!node.is_boolean()) fail(node, format("{} must be true or false", key));
  return **node.as_boolean();
}

double TomlFile::number(const toml::node& node, const std::string& key) const {
  double value = 0;
  if (node.is_integer()) {
    const std::int64_t whole_value = **node.as_integer();
    if (whole_value > kExact || whole_value < -kExact) fail(node, format("{} is beyond 2^53", key));
    value = static_cast<double>(whole_value);
  } else if (node.is_floating_point()) {
    value = **node.as_floating_point();
  } else {
    fail(node, format("{} must be a number", key));
  }
  if (!std::isfinite(value)) fail(node, format("{} is not finite", key));
  return value;
}

std::int64_t TomlFile::whole(const toml::node& node, const std::string& key, std::int64_t least,
                             std::int64_t most) const {
  const std::string range = format("{} must be a whole number from {} to {}", key, least, most);
  if (!node.is_integer()) fail(node, range);
  const std::int64_t value = **node.as_integer();
  if (value < least || value > most) fail(node, format("{}, not {}", range, value));
  return value;
}

std::vector<double> TomlFile::numbers(const toml::node& node, const std::string& key) const {
  std::vector<double> values;
  for (const toml::node& entry : array(node, key)) values.push_back(number(entry, key));
  return values;
}

}  // namespace hapgrid
