// Numbers as text, the same in every locale; and texts that strangers wrote, made safe for a
// terminal.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace hapgrid {

/// As few digits as read back to the same double ("0.05").
std::string to_text(double value);

/// Appends `value` with 17 significant digits, as %.17g in the C locale: reads back to the same
/// double, and equal texts mean equal doubles.
void append_digits17(std::string& text, double value);

/// `value` with `decimals` digits after the point ("1.023").
std::string fixed(double value, int decimals);

/// `value` with at most six significant digits, for people ("0.025", "1e-06").
std::string rounded(double value);

/// Reads a text that is a number and nothing else. @return whether it is one
template <class Number>
bool parse_number(std::string_view text, Number& value) {
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  return read.ec == std::errc() && read.ptr == end;
}

/// The same for two numbers, and what stands between them.
template <class Number>
bool parse_two(std::string_view text, char between, Number& first, Number& second) {
  const std::size_t at = text.find(between);
  return at != text.npos && parse_number(text.substr(0, at), first) &&
         parse_number(text.substr(at + 1), second);
}

/// One line of at most `limit` bytes, whatever a model, a shard or a file's name has in it. The
/// control characters of ASCII become blanks. '?' stands for a byte that is no UTF-8, and for a
/// character that is not seen (other control characters, marks of writing direction, separators of
/// lines, characters without width), because it can change how the rest is shown. Every text from
/// outside goes through here before it reaches a terminal.
std::string printable_line(std::string_view text, std::size_t limit = 200);

/// A unit as pictures and plots show it: "Å" for angstrom; any other as it is, in a printable line.
std::string unit_sign(std::string_view unit);

/// The same behind a number: "rope length" behind 1, where the model says "rope lengths".
std::string counted_unit(std::string_view unit, double number);

/// The same as printable_line() for a text of any length whose line ends and tabs are our own.
std::string printable_text(std::string_view text);

// Tables and numbers as the reports for people show them.

/// The columns of a terminal that a text in UTF-8 takes, where no character is wide.
std::size_t text_width(std::string_view text);
/// `text` with blanks behind it, or before it, up to `width` columns; a longer one as it is.
std::string left(std::string_view text, std::size_t width);
std::string right(std::string_view text, std::size_t width);

double microseconds(std::int64_t nanoseconds);
/// In 10^6 bytes: "1.2 MB", and "0.012 MB" below one.
std::string megabytes(std::uint64_t bytes);

}  // namespace hapgrid
