// What the model and its viewers must know of a chemical element.
#pragma once

#include <string_view>

namespace hapgrid::molecule {

struct Element {
  const char* symbol;
  double mass;      // unified atomic mass units
  double radius;    // van der Waals, Å
  double covalent;  // radius, Å
  float colour[3];  // red, green, blue in [0, 1]
};

/// The element with this symbol, of those in elements.toml; nullptr for others.
const Element* find_element(std::string_view symbol);

}  // namespace hapgrid::molecule
