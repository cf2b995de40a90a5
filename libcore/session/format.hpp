// Between structs and Cap'n Proto messages. Only for the sources of this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/digest.hpp"
#include "libcore/session/session.hpp"

namespace hapgrid {

inline constexpr std::size_t kChunkTicks = 4096;  ///< the most in a chunk
/// Bytes of content that a header's and a chunk's message can have at most, of any writer.
inline constexpr std::uint64_t kHeaderLimit = 1 << 20;
inline constexpr std::uint64_t kChunkLimit = 128 * kChunkTicks;

/// What the footer says of a chunk.
struct ChunkEntry {
  std::uint64_t offset = 0;  ///< of its zstd frame in the file
  std::uint64_t size = 0;    ///< of its zstd frame
  std::uint64_t first = 0;   ///< numbers of its first and last tick
  std::uint64_t last = 0;
  std::uint32_t ticks = 0;
  Digest digest;
};

struct SessionFooter {
  std::uint64_t ticks = 0;
  std::uint64_t dropped = 0;
  std::vector<ChunkEntry> chunks;
  Digest digest;  ///< of the digests of all messages before the footer, in their order
};

/// Messages, flat.
using Message = std::vector<std::uint64_t>;
Message encode_header(const SessionHeader& header);
/// 1 to kChunkTicks ticks, ascending.
Message encode_ticks(std::span<const TickRecord> ticks);
Message encode_footer(const SessionFooter& footer);

/// @throw FormatError (without the file's name) for any other or impossible content.
SessionHeader decode_header(const Message& message);
void decode_ticks(const Message& message, std::vector<TickRecord>& ticks);
/// @param most chunks that can be in the file.
SessionFooter decode_footer(const Message& message, std::uint64_t most);

}  // namespace hapgrid
