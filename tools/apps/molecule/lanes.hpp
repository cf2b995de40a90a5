// Several doubles in one register. Every x86-64 processor has registers of two; those with AVX2
// have registers of four, and elsewhere compilers take two registers of two for Four. Each lane is
// computed as it is alone, so the results have the same bits on every processor.
#pragma once

#include <cstring>

namespace hapgrid::molecule {

// GCC and Clang know the types on all processors.
using Two = double __attribute__((vector_size(16)));
using Four = double __attribute__((vector_size(32)));

template <class Lanes>
Lanes load(const double* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <class Lanes>
void store(double* p, const Lanes& v) {
  std::memcpy(p, &v, sizeof v);
}

}  // namespace hapgrid::molecule

/// Before a function's definition: it is compiled for processors with AVX2, too, and the program
/// takes what the processor has. It is for functions in which much of the search's time is spent.
/// Clang would want it before their declarations, and the thread sanitizer is not ready when the
/// program chooses.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define HAPGRID_WITH_AVX2 __attribute__((target_clones("default", "avx2")))
#else
#define HAPGRID_WITH_AVX2
#endif
