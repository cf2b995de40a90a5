// Signed differences as small numbers: 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
#pragma once

namespace hapgrid {

/// Of a difference modulo 2^width. U: an unsigned integer of `width` bits, or a vector of them.
template <class U>
constexpr U zigzag(U difference, unsigned width = 64) {
  return difference << 1 ^ (0 - (difference >> (width - 1)));
}

/// The other way, for any width.
template <class U>
constexpr U unzigzag(U z) {
  return z >> 1 ^ (0 - (z & 1));
}

}  // namespace hapgrid
