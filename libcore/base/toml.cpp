// The one source that compiles the parser of toml++.
#define TOML_IMPLEMENTATION
#include "libcore/base/toml.hpp"

#include <utf8proc.h>

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

/// What stands before the parser, which gets nothing but ASCII: toml++ 3.3, which Debian 12 has,
/// calls it unreachable when it asks whether some other letters are blanks
/// (https://github.com/marzer/tomlplusplus/issues/190). A text that is no TOML can mislead this
/// only behind the place where the parser refuses it.
class Guard {
 public:
  Guard(std::string_view text, const TomlFile& file) : text_(text), file_(file) {}

  /// The same values in the same lines.
  std::string in_ascii() {
    bool in_name = false;     // of a table, up to the end of the line
    bool line_begins = true;  // there were only blanks in it so far
    unsigned depth = 0;       // of arrays
    char last = ' ';          // but blanks and what is quoted
    unsigned dots = 0;        // without a comma, bracket or equals sign between them
    for (at_ = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0; at_ < text_.size();) {
      const char c = text_[at_];
      if (c == '#') {
        copy_comment();
      } else if (c == '"' || c == '\'') {
        copy_quoted(c);
        line_begins = false;
        last = c;
      } else {
        if (!is_ascii()) fail("a letter that is not ASCII is outside of quotes");
        if (c == '[' && line_begins && depth == 0) {
          check_name();
          in_name = true;
        }
        if (c == '}' && (last == '[' || last == ',')) fail("before } a value is missing");
        if (!in_name) depth = c == '[' ? depth + 1 : c == ']' && depth > 0 ? depth - 1 : depth;
        if (c == '.' && ++dots >= kMaxKeyParts)
          fail(format("a key of more than {} parts", kMaxKeyParts));
        if (std::strchr(",=[]{}\n", c)) dots = 0;
        in_name = in_name && c != '\n';
        line_begins = c == '\n' || (line_begins && (c == ' ' || c == '\t'));
        if (!std::strchr(" \t\r\n", c)) last = c;
        ascii_ += c;
        ++at_;
      }
    }
    return std::move(ascii_);
  }

 private:
  bool is_ascii() const { return static_cast<unsigned char>(text_[at_]) < 0x80; }

  [[noreturn]] void fail(const std::string& what) const {
    file_.fail(1 + static_cast<std::uint64_t>(std::count(text_.begin(), text_.begin() + at_, '\n')),
               what);
  }

  /// toml++ 3.3 asserts that a name begins behind "[" and "[["
  /// (https://github.com/marzer/tomlplusplus/pull/301). It says itself that there is none in "[]".
  void check_name() const {
    const std::size_t second = at_ + (text_.substr(at_).starts_with("[[") ? 2 : 1);
    const std::size_t begin = text_.find_first_not_of(" \t", second);
    if (begin != text_.npos && kNameBegins.find(text_[begin]) == text_.npos)
      fail("behind [ a table's name is missing");
  }

  void copy_comment() {
    while (at_ < text_.size() && text_[at_] != '\n') {
      if (is_ascii()) {
        ascii_ += text_[at_++];
      } else {
        letter();
        ascii_ += '?';
      }
    }
  }

  /// As it is, or, where it has other letters, as a text with escapes: "\U000000F6" for 'ö'.
  void copy_quoted(char quote) {
    const std::string marks(text_.substr(at_).starts_with(std::string(3, quote)) ? 3 : 1, quote);
    const bool escapes = quote == '"';
    std::size_t end = at_ + marks.size();
    while (end < text_.size() && !text_.substr(end).starts_with(marks) &&
           (marks.size() == 3 || text_[end] != '\n'))
      end += escapes && text_[end] == '\\' ? 2 : 1;
    if (end >= text_.size() || text_[end] != quote) fail("a text in quotes does not end");
    // Two quotes before the last three are the text's own.
    for (int own = 0; own < 2 && marks.size() == 3 && text_.substr(end + 3).starts_with(quote);
         ++own)
      ++end;
    const std::string_view all = text_.substr(at_, end + marks.size() - at_);
    if (std::none_of(all.begin(), all.end(),
                     [](char c) { return static_cast<unsigned char>(c) >= 0x80; })) {
      ascii_ += all;
      at_ += all.size();
      return;
    }
    ascii_.append(marks.size(), '"');
    for (at_ += marks.size(); at_ < end;) {
      if (!is_ascii()) {
        ascii_ += format("\\U{:08X}", letter());
        continue;
      }
      if (!escapes && (text_[at_] == '"' || text_[at_] == '\\')) ascii_ += '\\';
      ascii_ += text_[at_++];
      if (escapes && text_[at_ - 1] == '\\') {
        if (!is_ascii()) fail("a backslash is before a letter that is not ASCII");
        ascii_ += text_[at_++];
      }
    }
    ascii_.append(marks.size(), '"');
    at_ = end + marks.size();
  }

  /// The number of the letter that is here, and goes behind it.
  std::int32_t letter() {
    utf8proc_int32_t code = 0;
    const utf8proc_ssize_t bytes =
        utf8proc_iterate(reinterpret_cast<const utf8proc_uint8_t*>(text_.data()) + at_,
                         static_cast<utf8proc_ssize_t>(text_.size() - at_), &code);
    if (bytes <= 0) fail("this is no UTF-8");
    at_ += static_cast<std::size_t>(bytes);
    return code;
  }

  static constexpr std::string_view kNameBegins =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_\"']";

  const std::string_view text_;
  const TomlFile& file_;
  std::size_t at_ = 0;
  std::string ascii_;  // text_ up to at_
};

}  // namespace

void fail_toml(const char* expected) { throw Error(format("no TOML: expected {}", expected)); }

TomlFile::TomlFile(const std::string& text, std::string name) : name_(std::move(name)) {
  const std::string ascii = Guard(text, *this).in_ascii();
  try {
    root_ = toml::parse(ascii, std::string_view());
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
