// Integers as planes of bytes: the lowest byte of each, then the next byte of each, and so on. zstd
// finds more in bytes of one kind that stand together.
#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace hapgrid {

inline constexpr unsigned kMaxPlanes = 8;

/// How many planes hold all of `values`: 0 where all are 0, sizeof(T) at most.
template <std::unsigned_integral T>
unsigned planes_needed(std::span<const T> values) {
  T all = 0;
  for (const T v : values) all |= v;
  return (static_cast<unsigned>(std::bit_width(all)) + 7) / 8;
}

/// Shapes: R values, R * planes bytes.
template <std::unsigned_integral T>
void split_planes(std::span<const T> values, unsigned planes, std::uint8_t* bytes) {
  for (unsigned plane = 0; plane < planes; ++plane)
    for (const T v : values) *bytes++ = static_cast<std::uint8_t>(v >> (8 * plane));
}

/// The other way, of some of `rows` values: `bytes` is where the first of them has its lowest byte.
/// planes 0 to sizeof(T).
template <std::unsigned_integral T>
void join_planes(const std::uint8_t* bytes, std::size_t rows, unsigned planes,
                 std::span<T> values) {
  std::fill(values.begin(), values.end(), T{0});
  for (unsigned plane = 0; plane < planes; ++plane)
    for (std::size_t r = 0; r < values.size(); ++r)
      values[r] |= static_cast<T>(static_cast<T>(bytes[plane * rows + r]) << (8 * plane));
}

}  // namespace hapgrid
