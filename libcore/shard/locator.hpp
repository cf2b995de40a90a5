// The last bytes of a section: they say where its footer is, so that a reader of a file goes
// straight to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace hapgrid {

/// A skippable zstd frame, which `zstd -d` passes over: the magic number 0x184D2A5E and the size
/// 16, as UInt32, and the two numbers of the Locator, as UInt64, all little-endian.
inline constexpr std::size_t kLocatorBytes = 24;

struct Locator {
  std::uint64_t size = 0;  ///< of the footer's zstd frame, which ends where the locator starts
  std::uint64_t hash = 0;  ///< XXH3-64 of that zstd frame
};

std::array<std::byte, kLocatorBytes> encode_locator(const Locator& locator);
/// Nothing when the bytes are no locator.
std::optional<Locator> decode_locator(std::span<const std::byte, kLocatorBytes> bytes);

}  // namespace hapgrid
