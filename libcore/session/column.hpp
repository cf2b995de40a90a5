// Columns of doubles in a form that zstd compresses well. Only for the sources of this folder.
//
// A hand moves smoothly: from tick to tick sign, exponent and the upper bits of the fraction hardly
// change. But zstd, which looks for repeated bytes, does not see that through the noise of the
// lower bits. The difference of neighbours has zeros in place of the bits that stay the same, and
// bytes of one significance side by side keep the zeros together. schemas/session.capnp defines
// each bit.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "libcore/base/zigzag.hpp"
#include "libcore/session/session.hpp"

namespace hapgrid {

/// Byte b of the number i of n is at b n + i.
inline void put_bytes(std::uint8_t* to, std::size_t n, std::size_t i, std::uint64_t u) {
  for (std::size_t b = 0; b < 8; ++b) to[b * n + i] = static_cast<std::uint8_t>(u >> 8 * b);
}
inline std::uint64_t get_bytes(const std::uint8_t* from, std::size_t n, std::size_t i) {
  std::uint64_t u = 0;
  for (std::size_t b = 0; b < 8; ++b) u |= std::uint64_t{from[b * n + i]} << 8 * b;
  return u;
}

/// Three columns of differences to the tick before; `to` has 24 bytes a tick.
inline void encode_differences(std::span<const TickRecord> ticks, Vec3 TickRecord::*member,
                               std::uint8_t* to) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, to += 8 * n)
    for (std::uint64_t i = 0, before = 0; i < n; ++i) {
      const auto bits = std::bit_cast<std::uint64_t>((ticks[i].*member)[axis]);
      put_bytes(to, n, i, zigzag(bits - before));
      before = bits;
    }
}
inline void decode_differences(const std::uint8_t* from, Vec3 TickRecord::*member,
                               std::span<TickRecord> ticks) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, from += 8 * n)
    for (std::uint64_t i = 0, bits = 0; i < n; ++i) {
      bits += unzigzag(get_bytes(from, n, i));
      (ticks[i].*member)[axis] = std::bit_cast<double>(bits);
    }
}

/// Three columns of the bits in which the force differs from the raw one; `to` has 24 bytes a tick.
inline void encode_force(std::span<const TickRecord> ticks, std::uint8_t* to) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, to += 8 * n)
    for (std::size_t i = 0; i < n; ++i)
      put_bytes(to, n, i,
                std::bit_cast<std::uint64_t>(ticks[i].force[axis]) ^
                    std::bit_cast<std::uint64_t>(ticks[i].raw_force[axis]));
}
inline void decode_force(const std::uint8_t* from, std::span<TickRecord> ticks) {
  const std::size_t n = ticks.size();
  for (int axis = 0; axis < 3; ++axis, from += 8 * n)
    for (std::size_t i = 0; i < n; ++i)
      ticks[i].force[axis] = std::bit_cast<double>(
          get_bytes(from, n, i) ^ std::bit_cast<std::uint64_t>(ticks[i].raw_force[axis]));
}

}  // namespace hapgrid
