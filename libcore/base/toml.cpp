#include "libcore/base/toml.hpp"

#include <cstdint>
#include <cstring>
#include <string_view>

#include "libcore/base/error.hpp"

namespace hapgrid {

namespace {

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

toml::table parse_toml(const std::string& text, const std::string& name) {
  const auto refuse = [&](std::uint64_t line, const std::string& what) {
    throw Error(name + ": line " + std::to_string(line) + ": " + what);
  };
  if (const std::uint64_t line = overlong_key(text))
    refuse(line, "a key of more than " + std::to_string(kMaxKeyParts) + " parts");
  try {
    return toml::parse(text, std::string_view());
  } catch (const toml::parse_error& e) {
    refuse(e.source().begin.line, std::string(e.description()));
  }
  return {};
}

}  // namespace hapgrid
