// What tells whether bytes are the ones that were written: XXH3, seed 0.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hapgrid {

/// XXH3-128.
struct Digest {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  friend bool operator==(const Digest&, const Digest&) = default;
};
Digest digest_of(std::span<const std::byte> bytes);

}  // namespace hapgrid
