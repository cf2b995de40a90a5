// Random numbers that are the same everywhere.
#pragma once

#include <cstdint>

namespace hapgrid {

/// SplitMix64 (Steele, Lea, Flood 2014): the standard library's distributions differ between
/// implementations, and a sample must not.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  /// A number below `bound`; the bias of the remainder is below 2^-32 for 32-bit bounds.
  std::uint64_t below(std::uint64_t bound) {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (z ^ (z >> 31)) % bound;
  }

 private:
  std::uint64_t state_;
};

}  // namespace hapgrid
