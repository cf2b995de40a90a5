#include "libcore/base/digest.hpp"

#include <xxhash.h>

#include <bit>

namespace hapgrid {

static_assert(sizeof(Digest) == 16 && std::endian::native == std::endian::little,
              "digests of digests are hashed as they are in memory");

Digest digest_of(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.low64, hash.high64};
}

}  // namespace hapgrid
