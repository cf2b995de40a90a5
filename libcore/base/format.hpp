// Texts with values in them, by the format strings of fmt (https://fmt.dev).
#pragma once

#include <fmt/core.h>

#include <string>

namespace hapgrid {

/// As fmt::vformat(). fmt itself is compiled in format.cpp alone: each source that compiles it takes
/// six seconds more.
std::string vformat(fmt::string_view text, fmt::format_args args);

/// As fmt::format(): format("{}: {} of {} records", name, done, all). The compiler checks the text.
template <class... Values>
std::string format(fmt::format_string<Values...> text, Values&&... values) {
  return hapgrid::vformat(text, fmt::make_format_args(values...));
}

}  // namespace hapgrid
