#include "libcore/shard/format.hpp"

#include <algorithm>
#include <bit>

namespace hapgrid {

const char* to_string(Content content) { return content == Content::kGrid ? "grid" : "requests"; }

Digest section_digest(const Digest& header, std::span<const ChunkInfo> chunks) {
  std::vector<Digest> digests{header};
  digests.reserve(chunks.size() + 1);
  for (const ChunkInfo& chunk : chunks) digests.push_back(chunk.digest);
  return digest_of(std::as_bytes(std::span(digests)));
}

std::uint64_t record_bytes(std::uint32_t row_size) {
  return sizeof(PointIndex) + sizeof(Level) + sizeof(std::uint32_t) +
         sizeof(double) * std::uint64_t{row_size} + kDirections;
}

std::uint32_t chunk_points(std::uint32_t row_size, std::uint64_t bytes) {
  const std::uint64_t fit = bytes / record_bytes(row_size);
  return static_cast<std::uint32_t>(std::bit_floor(std::max<std::uint64_t>(fit, 1)));
}

std::uint32_t chunk_requests(std::uint32_t row_size) {
  const std::uint64_t request = sizeof(PointIndex) + 2 + sizeof(double) * std::uint64_t{row_size};
  return static_cast<std::uint32_t>(std::max<std::uint64_t>(kChunkBytes / request, kDirections));
}

}  // namespace hapgrid
