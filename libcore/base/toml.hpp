// TOML files as hapgrid reads them: each mistake is one line with the file, the line in it, the
// key, and its limit; an unknown key is a mistake, too.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace hapgrid {
/// Throws Error: "no TOML: expected ...".
[[noreturn]] void fail_toml(const char* expected);
}  // namespace hapgrid

// The parser is compiled once, in toml.cpp. What toml++ asserts, a hostile text could break: it is
// checked in every build.
#define TOML_HEADER_ONLY 0
#define TOML_ASSERT(expected) ((expected) ? void() : hapgrid::fail_toml(#expected))
#pragma push_macro("NDEBUG")
#undef NDEBUG
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace hapgrid {

/// A parsed file, and checked ways into it. All throw Error "NAME: line N: ...".
class TomlFile {
 public:
  /// @param text the contents, hostile.
  /// @param name for messages.
  TomlFile(const std::string& text, std::string name);

  const toml::table& root() const { return root_; }
  toml::table& root() { return root_; }

  [[noreturn]] void fail(std::uint64_t line, const std::string& what) const;
  [[noreturn]] void fail(const toml::node& node, const std::string& what) const;

  /// @param prefix of the keys in messages: "grid.".
  void only_keys(const toml::table& table, const std::string& prefix,
                 std::initializer_list<std::string_view> known) const;
  const toml::table& table(const toml::table& in, const std::string& key) const;
  const toml::node& required(const toml::table& in, const std::string& prefix,
                             const char* key) const;
  std::string text(const toml::node& node, const std::string& key) const;
  const toml::array& array(const toml::node& node, const std::string& key) const;
  bool boolean(const toml::node& node, const std::string& key) const;
  /// A finite number; a whole one must have an exact double.
  double number(const toml::node& node, const std::string& key) const;
  std::int64_t whole(const toml::node& node, const std::string& key, std::int64_t least,
                     std::int64_t most) const;
  std::vector<double> numbers(const toml::node& node, const std::string& key) const;

 private:
  std::string name_;
  toml::table root_;
};

}  // namespace hapgrid
