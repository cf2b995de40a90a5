#include "libcore/shard/section_digest.hpp"

#define XXH_STATIC_LINKING_ONLY  // XXH3_state_t's size: the library is Debian's, header and all
#include <xxhash.h>

namespace hapgrid {

struct SectionDigester::State {
  XXH3_state_t hash;
};

SectionDigester::SectionDigester(std::span<const std::byte> header)
    : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->hash);
  XXH3_128bits_update(&state_->hash, header.data(), header.size());
}
SectionDigester::~SectionDigester() = default;
SectionDigester::SectionDigester(SectionDigester&&) noexcept = default;

void SectionDigester::add(const Digest& chunk) {
  const std::uint64_t words[2] = {chunk.low, chunk.high};
  XXH3_128bits_update(&state_->hash, words, sizeof words);
}

Digest SectionDigester::digest() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_->hash);
  return {hash.low64, hash.high64};
}

}  // namespace hapgrid
