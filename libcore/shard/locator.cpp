#include "libcore/shard/locator.hpp"

#include <bit>
#include <cstring>

namespace hapgrid {

static_assert(std::endian::native == std::endian::little, "the locator is as it is in memory");

namespace {

constexpr std::uint32_t kStart[] = {0x184D2A5E, 16};  // a skippable zstd frame of 16 bytes

}  // namespace

std::array<std::byte, kLocatorBytes> encode_locator(const Locator& locator) {
  std::array<std::byte, kLocatorBytes> bytes;
  std::memcpy(bytes.data(), kStart, 8);
  std::memcpy(bytes.data() + 8, &locator.size, 8);
  std::memcpy(bytes.data() + 16, &locator.hash, 8);
  return bytes;
}

std::optional<Locator> decode_locator(std::span<const std::byte, kLocatorBytes> bytes) {
  if (std::memcmp(bytes.data(), kStart, 8) != 0) return std::nullopt;
  Locator locator;
  std::memcpy(&locator.size, bytes.data() + 8, 8);
  std::memcpy(&locator.hash, bytes.data() + 16, 8);
  return locator;
}

}  // namespace hapgrid
