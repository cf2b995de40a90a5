#include "examples/molecule/elements.hpp"

namespace hapgrid::molecule {

const Element* find_element(unsigned atomic_number) {
  switch (atomic_number) {
#define HAPGRID_ELEMENT(number, symbol, mass, radius, r, g, b)     \
  case number: {                                                   \
    static const Element element{symbol, mass, radius, {r, g, b}}; \
    return &element;                                               \
  }
    HAPGRID_ELEMENT(1, "H", 1.008, 1.20, 1.00F, 1.00F, 1.00F)
    HAPGRID_ELEMENT(2, "He", 4.0026, 1.40, 0.85F, 1.00F, 1.00F)
    HAPGRID_ELEMENT(6, "C", 12.011, 1.70, 0.45F, 0.45F, 0.45F)
    HAPGRID_ELEMENT(7, "N", 14.007, 1.55, 0.19F, 0.31F, 0.97F)
    HAPGRID_ELEMENT(8, "O", 15.999, 1.52, 0.93F, 0.05F, 0.05F)
    HAPGRID_ELEMENT(9, "F", 18.998, 1.47, 0.56F, 0.88F, 0.31F)
    HAPGRID_ELEMENT(10, "Ne", 20.180, 1.54, 0.70F, 0.89F, 0.96F)
    HAPGRID_ELEMENT(14, "Si", 28.085, 2.10, 0.94F, 0.78F, 0.63F)
    HAPGRID_ELEMENT(15, "P", 30.974, 1.80, 1.00F, 0.50F, 0.00F)
    HAPGRID_ELEMENT(16, "S", 32.06, 1.80, 1.00F, 0.90F, 0.19F)
    HAPGRID_ELEMENT(17, "Cl", 35.45, 1.75, 0.12F, 0.94F, 0.12F)
    HAPGRID_ELEMENT(18, "Ar", 39.95, 1.88, 0.50F, 0.82F, 0.89F)
    HAPGRID_ELEMENT(33, "As", 74.922, 1.85, 0.74F, 0.50F, 0.89F)
    HAPGRID_ELEMENT(34, "Se", 78.971, 1.90, 1.00F, 0.63F, 0.00F)
    HAPGRID_ELEMENT(35, "Br", 79.904, 1.85, 0.65F, 0.16F, 0.16F)
    HAPGRID_ELEMENT(36, "Kr", 83.798, 2.02, 0.36F, 0.72F, 0.82F)
    HAPGRID_ELEMENT(52, "Te", 127.60, 2.06, 0.83F, 0.48F, 0.00F)
    HAPGRID_ELEMENT(53, "I", 126.90, 1.98, 0.58F, 0.00F, 0.58F)
    HAPGRID_ELEMENT(54, "Xe", 131.29, 2.16, 0.26F, 0.62F, 0.69F)
#undef HAPGRID_ELEMENT
    default:
      return nullptr;
  }
}

}  // namespace hapgrid::molecule
