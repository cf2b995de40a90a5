// Two doubles in one register. Every x86-64 processor has such registers.
#pragma once

#include <cstring>

namespace hapgrid::molecule {

// GCC and Clang know the type on all processors.
using Two = double __attribute__((vector_size(16)));
static_assert(sizeof(Two) == 2 * sizeof(double));

inline Two load(const double* p) {
  Two v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(double* p, Two v) { std::memcpy(p, &v, sizeof v); }

}  // namespace hapgrid::molecule
