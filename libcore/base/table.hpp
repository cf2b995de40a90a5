// Tables and numbers as the reports for people show them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace hapgrid {

/// The columns of a terminal that a text in UTF-8 takes, where no character is wide.
std::size_t text_width(std::string_view text);
/// `text` with blanks behind it, or before it, up to `width` columns; a longer one as it is.
std::string left(std::string_view text, std::size_t width);
std::string right(std::string_view text, std::size_t width);

/// With three significant digits, as %.3g.
std::string three_digits(double value);
double microseconds(std::int64_t nanoseconds);
/// In 10^6 bytes: "1.2 MB", and "0.012 MB" below one.
std::string megabytes(std::uint64_t bytes);

}  // namespace hapgrid
