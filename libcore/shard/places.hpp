// Doubles and their residuals as integers, for one number and for several side by side.
#pragma once

#include <cstdint>

#include "libcore/base/zigzag.hpp"

namespace hapgrid {

inline constexpr std::uint64_t kSignBit = std::uint64_t{1} << 63;

/// The place of a double among all doubles whose `shift` lowest bits are 0: integers in the same
/// order, -0 below +0. They count in steps of 2^shift, modulo 2^64, which leaves the bits where
/// they are. Bits: std::uint64_t, or a vector of them.
template <class Bits>
struct Places {
  Bits half;   ///< of a step; 0 without a shift
  Bits kept;   ///< the bits that are not 0 in all values
  Bits shift;  ///< 0 to 52

  /// Of a double with no other bits than those kept.
  Bits of(Bits bits) const { return bits ^ (kSignBit | (kept & (0 - (bits >> 63)))); }
  /// Of the nearest such double.
  Bits nearest(Bits bits) const { return of((bits + half) & kept); }
  /// The bits of the double at a place.
  Bits back(Bits place) const { return place ^ (kSignBit | (kept & ((place >> 63) - 1))); }

  /// Of the bits of a value, and of its prediction.
  Bits residual(Bits value, Bits predicted) const {
    return zigzag(of(value) - nearest(predicted)) >> shift;
  }
  /// The other way.
  Bits value(Bits residual, Bits predicted) const {
    return back(nearest(predicted) + (unzigzag(residual) << shift));
  }
};

inline Places<std::uint64_t> places_of_doubles(unsigned shift) {
  return {shift > 0 ? std::uint64_t{1} << (shift - 1) : 0, ~std::uint64_t{0} << shift, shift};
}

}  // namespace hapgrid
