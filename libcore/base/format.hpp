// Texts with values in them, by the format strings of fmt (https://fmt.dev).
#pragma once

#include <fmt/core.h>

#include <string>

namespace hapgrid {

/// As fmt::vformat(). fmt takes long to compile, and so is compiled in format.cpp alone.
std::string vformat(fmt::string_view text, fmt::format_args args);

/// As fmt::format(): format("{}: {} of {} records", name, done, all). The compiler checks the text.
/// An object and no function: for a function's name the compiler also looks into the namespaces of
/// the values, and for a std::string it would find std::format there, which GCC has from 13 on.
inline constexpr auto format = []<class... Values>(fmt::format_string<Values...> text,
                                                   Values&&... values) {
  return hapgrid::vformat(text, fmt::make_format_args(values...));
};

}  // namespace hapgrid
