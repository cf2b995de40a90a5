#include "libcore/base/text.hpp"

#include <array>
#include <charconv>

namespace hapgrid {

namespace {
constexpr int kDigits = 32;        // sign, point, 17 digits, e-308
constexpr int kFixedDigits = 400;  // sign, 309 digits, point, and the few decimals of a report
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
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    // What is no UTF-8, or was cut, would not be shown or could not be searched for.
    const std::size_t length = byte < 0x80   ? 1
                               : byte < 0xc2 ? 0
                               : byte < 0xe0 ? 2
                               : byte < 0xf0 ? 3
                                             : 4;
    bool whole = length > 0 && byte < 0xf5 && i + length <= text.size();
    for (std::size_t k = 1; whole && k < length; ++k)
      whole = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
    // U+0080 to U+009F are control characters, which some terminals obey.
    whole = whole && !(byte == 0xc2 && static_cast<unsigned char>(text[i + 1]) < 0xa0);
    if (!whole) {
      line += '?';
    } else if (byte < 0x20 || byte == 0x7f) {
      line += ' ';
    } else {
      line += text.substr(i, length);
    }
    i += whole ? length : 1;
  }
  return line;
}

}  // namespace hapgrid
