#include "tools/apps/molecule/elements.hpp"

#include <algorithm>

namespace hapgrid::molecule {

namespace {
constexpr Element kElements[] = {
#include "elements.inc"  // of elements.toml, by elements.cmake
};
}  // namespace

const Element* find_element(std::string_view symbol) {
  const Element* found = std::find_if(std::begin(kElements), std::end(kElements),
                                      [&](const Element& one) { return one.symbol == symbol; });
  return found == std::end(kElements) ? nullptr : found;
}

}  // namespace hapgrid::molecule
