// The end of the file.
#include <bit>
#include <cstring>

#include "libcore/session/format.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little, "the locator is as it is in memory");

namespace {

constexpr std::uint32_t kLocatorMagic = 0x184D2A5E;  // a skippable frame
constexpr std::uint32_t kLocatorContent = 16;

}  // namespace

std::array<std::byte, kLocatorBytes> encode_locator(const Locator& locator) {
  std::array<std::byte, kLocatorBytes> bytes;
  std::memcpy(bytes.data(), &kLocatorMagic, 4);
  std::memcpy(bytes.data() + 4, &kLocatorContent, 4);
  std::memcpy(bytes.data() + 8, &locator.footer, 8);
  std::memcpy(bytes.data() + 16, &locator.hash, 8);
  return bytes;
}

bool decode_locator(std::span<const std::byte, kLocatorBytes> bytes, Locator& locator) {
  if (std::memcmp(bytes.data(), &kLocatorMagic, 4) != 0 ||
      std::memcmp(bytes.data() + 4, &kLocatorContent, 4) != 0)
    return false;
  std::memcpy(&locator.footer, bytes.data() + 8, 8);
  std::memcpy(&locator.hash, bytes.data() + 16, 8);
  return true;
}

}  // namespace hapgrid
