#include "libcore/base/text.hpp"

#include <utf8proc.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "libcore/base/format.hpp"

namespace hapgrid {

namespace {
constexpr int kDigits = 32;        // sign, point, 17 digits, e-308
constexpr int kFixedDigits = 400;  // sign, 309 digits, point, and the few decimals of a report

/// Whether a terminal shows the character where it stands. Not shown are control characters, marks
/// of writing direction, separators of lines, characters without width, and what Unicode does not
/// define.
bool is_visible(utf8proc_int32_t character) {
  switch (utf8proc_category(character)) {
    case UTF8PROC_CATEGORY_CN:  // not assigned
    case UTF8PROC_CATEGORY_CC:
    case UTF8PROC_CATEGORY_CF:
    case UTF8PROC_CATEGORY_ZL:
    case UTF8PROC_CATEGORY_ZP:
      return false;
    default:
      return !utf8proc_get_property(character)->ignorable;
  }
}

}  // namespace

std::string to_text(double value) {
  char buffer[kDigits];
  return std::string(buffer, std::to_chars(buffer, buffer + kDigits, value).ptr);
}

void append_digits17(std::string& text, double value) {
  char buffer[kDigits];
  text.append(buffer,
              std::to_chars(buffer, buffer + kDigits, value, std::chars_format::general, 17).ptr);
}

std::string fixed(double value, int decimals) {
  std::array<char, kFixedDigits> digits;
  const auto end =
      std::to_chars(digits.begin(), digits.end(), value, std::chars_format::fixed, decimals).ptr;
  return std::string(digits.begin(), end);
}

std::string rounded(double value) {
  char buffer[kDigits];
  return std::string(
      buffer, std::to_chars(buffer, buffer + kDigits, value, std::chars_format::general, 6).ptr);
}

std::string printable_line(std::string_view text, std::size_t limit) {
  text = text.substr(0, limit);
  std::string line;
  while (!text.empty()) {
    utf8proc_int32_t character = 0;
    const auto* const bytes = reinterpret_cast<const utf8proc_uint8_t*>(text.data());
    const utf8proc_ssize_t size =
        utf8proc_iterate(bytes, static_cast<utf8proc_ssize_t>(text.size()), &character);
    const auto count = static_cast<std::size_t>(std::max<utf8proc_ssize_t>(size, 1));
    if (size > 0 && (character < 0x20 || character == 0x7f))
      line += ' ';
    else
      line += size > 0 && is_visible(character) ? text.substr(0, count) : "?";
    text.remove_prefix(count);
  }
  return line;
}

std::string printable_text(std::string_view text) {
  std::string lines;
  for (std::size_t end; (end = text.find_first_of("\n\t")) != text.npos;
       text.remove_prefix(end + 1))
    lines += printable_line(text.substr(0, end), text.npos) + text[end];
  return lines + printable_line(text, text.npos);
}

std::string unit_sign(std::string_view unit) {
  return unit == "angstrom" ? "Å" : printable_line(unit, 24);
}

std::string counted_unit(std::string_view unit, double number) {
  std::string sign = unit_sign(unit);
  const std::size_t size = sign.size(), word = size - (sign.rfind(' ') + 1);
  if (number != 1 || word < 4 || !sign.ends_with('s')) return sign;
  for (const char before : {'s', 'u', 'i'})  // glass, radius, axis
    if (sign[size - 2] == before) return sign;
  return sign.substr(0, size - (sign.ends_with("ches") ? 2 : 1));
}

namespace {

std::string blanks(std::string_view text, std::size_t width) {
  return std::string(width - std::min(width, text_width(text)), ' ');
}

}  // namespace

std::size_t text_width(std::string_view text) {
  const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins));
}

std::string left(std::string_view text, std::size_t width) {
  return std::string(text) + blanks(text, width);
}

std::string right(std::string_view text, std::size_t width) {
  return blanks(text, width) + std::string(text);
}

double microseconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-3; }

std::string megabytes(std::uint64_t bytes) {
  return fixed(static_cast<double>(bytes) / 1e6, bytes < 1'000'000 ? 3 : 1) + " MB";
}

}  // namespace hapgrid
