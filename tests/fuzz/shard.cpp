// Shards as bytes: frames, what stands around them, and whatever passes their checksums.
#include "tests/fuzz/read_shard.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hapgrid::fuzz::read_shard(std::as_bytes(std::span(data, size)));
  return 0;
}
