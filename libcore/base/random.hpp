// Random numbers that are the same everywhere.
#pragma once

#include <cstdint>

namespace hapgrid {

/// The last steps of SplitMix64: each bit of the result depends on all bits of z.
inline std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// SplitMix64 (Steele, Lea, Flood 2014): the standard library's distributions differ between
/// implementations, and a sample must not.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  /// A number below `bound`; the bias of the remainder is below 2^-32 for 32-bit bounds.
  std::uint64_t below(std::uint64_t bound) { return mix(state_ += kStep) % bound; }
  /// In [0, 1), with 53 random bits.
  double part() { return static_cast<double>(below(std::uint64_t{1} << 53)) * 0x1p-53; }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;  // 2^64 over the golden ratio
  std::uint64_t state_;
};

}  // namespace hapgrid
