#include "libcore/base/format.hpp"

#include <fmt/format.h>

namespace hapgrid {

std::string vformat(fmt::string_view text, fmt::format_args args) {
  return fmt::vformat(text, args);
}

}  // namespace hapgrid
