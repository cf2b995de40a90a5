#include "libcore/base/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>

namespace hapgrid {

namespace {
constexpr int kDigits = 32;        // sign, point, 17 digits, e-308
constexpr int kFixedDigits = 400;  // sign, 309 digits, point, and the few decimals of a report

constexpr char32_t kNoCharacter = 0xffffffff;

struct Character {
  char32_t code;
  std::size_t bytes;
};

/// The first character of a text that is not empty; kNoCharacter and one byte for what is no UTF-8
/// (RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF).
Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
  if (lead < 0xc2 || lead > 0xf4 || bytes > text.size()) return {kNoCharacter, 1};
  char32_t code = lead & (0xffU >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {kNoCharacter, 1};
    code = code << 6 | (byte(i) & 0x3fU);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kLeast[bytes] || surrogate || code > 0x10ffff) return {kNoCharacter, 1};
  return {code, bytes};
}

/// Unicode's general categories Cc, Cf, Zl and Zp, and its Default_Ignorable_Code_Point.
bool is_unseen(char32_t code) {
  struct Range {
    char32_t first, last;
  };
  static constexpr Range kUnseen[] = {
      {0x00, 0x1f},       {0x7f, 0x9f},       {0xad, 0xad},       {0x34f, 0x34f},
      {0x600, 0x605},     {0x61c, 0x61c},     {0x6dd, 0x6dd},     {0x70f, 0x70f},
      {0x890, 0x891},     {0x8e2, 0x8e2},     {0x115f, 0x1160},   {0x17b4, 0x17b5},
      {0x180b, 0x180f},   {0x200b, 0x200f},   {0x2028, 0x202e},   {0x2060, 0x206f},
      {0x3164, 0x3164},   {0xfe00, 0xfe0f},   {0xfeff, 0xfeff},   {0xffa0, 0xffa0},
      {0xfff0, 0xfffb},   {0x110bd, 0x110bd}, {0x110cd, 0x110cd}, {0x13430, 0x1345f},
      {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a}, {0xe0000, 0xe0fff}};
  const auto* const range = std::lower_bound(std::begin(kUnseen), std::end(kUnseen), code,
                                             [](const Range& r, char32_t c) { return r.last < c; });
  return range != std::end(kUnseen) && code >= range->first;
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
    const Character next = first_character(text);
    const bool is_control = next.code < 0x20 || next.code == 0x7f;
    if (next.code == kNoCharacter || (!is_control && is_unseen(next.code)))
      line += '?';
    else
      line += is_control ? std::string_view(" ") : text.substr(0, next.bytes);
    text.remove_prefix(next.bytes);
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

std::string axis_label(std::string_view quantity, std::string_view unit) {
  const std::string sign = unit_sign(unit);
  const bool quotient = sign.find('/') != sign.npos;
  return std::string(quantity) + " / " + (quotient ? "(" + sign + ")" : sign);
}

}  // namespace hapgrid
