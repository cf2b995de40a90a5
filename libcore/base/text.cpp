#include "libcore/base/text.hpp"

#include <charconv>

namespace hapgrid {

namespace {
constexpr int kDigits = 32;  // sign, point, 17 digits, e-308
}

std::string to_text(double value) {
  char buffer[kDigits];
  return std::string(buffer, std::to_chars(buffer, buffer + kDigits, value).ptr);
}

void append_digits17(std::string& text, double value) {
  char buffer[kDigits];
  text.append(buffer,
              std::to_chars(buffer, buffer + kDigits, value, std::chars_format::general, 17).ptr);
}

}  // namespace hapgrid
