#include "examples/molecule/elements.hpp"

namespace hapgrid::molecule {

const Element* find_element(unsigned atomic_number) {
  switch (atomic_number) {
#define HAPGRID_ELEMENT(number, symbol, mass, radius, covalent, r, g, b) \
  case number: {                                                         \
    static const Element element{symbol, mass, radius, {r, g, b}};       \
    return &element;                                                     \
  }
#include "examples/molecule/elements.inc"
#undef HAPGRID_ELEMENT
    default:
      return nullptr;
  }
}

}  // namespace hapgrid::molecule
