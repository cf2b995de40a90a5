// With polynomials of which order a column is predicted.
#pragma once

#include <cstdint>
#include <span>

#include "libcore/shard/stencil.hpp"

namespace hapgrid {

/// How many rows back a column is predicted along each axis; 0 to 3 each.
struct Orders {
  std::uint8_t i = 0;
  std::uint8_t j = 0;
  std::uint8_t k = 0;

  std::uint8_t packed() const { return static_cast<std::uint8_t>(i | j << 2 | k << 4); }
  /// Takes the six lowest bits.
  static Orders unpacked(std::uint8_t packed) {
    return {static_cast<std::uint8_t>(packed & 3), static_cast<std::uint8_t>(packed >> 2 & 3),
            static_cast<std::uint8_t>(packed >> 4 & 3)};
  }
};

/// Orders that leave small residuals, by trial on some of the R rows: the same for the same column.
/// `values`: the bits of doubles of which the `shift` lowest are 0.
Orders choose_orders_of_doubles(const Stencil& stencil, unsigned shift,
                                std::span<const std::uint64_t> values);
Orders choose_orders_of_integers(const Stencil& stencil, std::span<const std::uint64_t> values);

}  // namespace hapgrid
