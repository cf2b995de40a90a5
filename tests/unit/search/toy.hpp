// A model without physics for the tests of the search: the state reached depends on the way, and
// equality is far from transitive, so that every change of order shows. The plug-in plugins/toy.cpp
// and the reference search (reference.hpp) share these functions and nothing else.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace toy {

struct Toy {
  std::uint32_t state_size = 1;  // n
  std::uint64_t salt = 0;        // which of the many models
  double amplitude = 1;          // how far a conversion moves the first two components, <= 1
  double tolerance = 0.25;       // in each of them
  double memory = 1;             // what a conversion keeps of them: below 1, levels die out
};

/// splitmix64.
inline std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
  x = (x ^ x >> 27) * 0x94d049bb133111eb;
  return x ^ x >> 31;
}
/// In [0, 1).
inline double fraction(std::uint64_t x) { return static_cast<double>(x >> 11) * 0x1p-53; }

/// C(s, x, d). The first two components live on the circle [0, 1), so a point has at most
/// (1 / tolerance + 1)^2 levels; the others follow from them.
inline void convert(const Toy& toy, const double* s, const double* x, const double* d,
                    double* result) {
  std::uint64_t way = mix(toy.salt);
  for (int a = 0; a < 3; ++a) {
    way = mix(way ^ static_cast<std::uint64_t>(std::llround(x[a] * 64)));
    way = mix(way ^ static_cast<std::uint64_t>(std::llround(d[a] * 64)));
  }
  for (std::uint32_t c = 0; c < toy.state_size; ++c) {
    if (c < 2) {
      const double moved = toy.memory * s[c] + toy.amplitude * fraction(mix(way + c));
      result[c] = moved - std::floor(moved);
    } else {
      result[c] = result[c - 1] * 0.75 + s[c] * 0.125 + c;
    }
  }
}

inline bool equal(const Toy& toy, const double* a, const double* b) {
  for (std::uint32_t c = 0; c < toy.state_size && c < 2; ++c)
    if (!(std::abs(a[c] - b[c]) <= toy.tolerance)) return false;
  return true;
}

}  // namespace toy
