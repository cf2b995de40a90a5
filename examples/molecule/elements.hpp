// What the model and its viewers must know of a chemical element.
#pragma once

namespace hapgrid::molecule {

struct Element {
  const char* symbol;
  double mass;      // unified atomic mass units
  double radius;    // van der Waals, Å
  float colour[3];  // red, green, blue in [0, 1]
};

/// The element with the given atomic number; nullptr when Bondi gives no radius for it.
/// Sources: radii from A. Bondi, J. Phys. Chem. 68 (1964) 441, tables I and XIV; masses from IUPAC
/// 2021, abridged; colours after Corey, Pauling and Koltun, as viewers have them.
const Element* find_element(unsigned atomic_number);

}  // namespace hapgrid::molecule
