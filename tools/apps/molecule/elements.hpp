// What the model and its viewers must know of a chemical element.
#pragma once

namespace hapgrid::molecule {

struct Element {
  unsigned number;
  const char* symbol;
  double mass;      // unified atomic mass units
  double radius;    // van der Waals, Å
  float colour[3];  // red, green, blue in [0, 1]
};

/// The element with the given atomic number, of those in elements.toml; nullptr for others.
const Element* find_element(unsigned atomic_number);

}  // namespace hapgrid::molecule
