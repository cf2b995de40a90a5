#define XXH_INLINE_ALL  // compiled here, for any processor
#include "libcore/base/digest.hpp"

#include <xxhash.h>

#include "tests/unit/catch.hpp"

using namespace hapgrid;

TEST_CASE("a digest is XXH3 of 128 bits, whatever instructions the processor has") {
  std::mt19937_64 random(1);
  std::vector<std::byte> bytes(100'003);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  // XXH3 goes other ways up to 16, 128, 240 and 1,024 bytes, and for whole and cut stripes of 64.
  for (std::size_t size = 0; size <= bytes.size(); size += size < 2'100 ? 1 : 9'973) {
    const XXH128_hash_t wanted = XXH3_128bits(bytes.data(), size);
    REQUIRE(digest_of(std::span(bytes).first(size)) == Digest{wanted.low64, wanted.high64});
  }
}
