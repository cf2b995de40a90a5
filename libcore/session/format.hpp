// Between structs, Cap'n Proto messages and zstd frames. Only for the sources of this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/session/session.hpp"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace hapgrid {

inline constexpr std::size_t kChunkTicks = 4096;  ///< the most in a chunk
/// Bytes of content that a header's and a chunk's message can have at most, of any writer.
inline constexpr std::uint64_t kHeaderLimit = 1 << 20;
inline constexpr std::uint64_t kChunkLimit = 128 * kChunkTicks;

/// XXH3-128.
struct SessionDigest {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
  friend bool operator==(const SessionDigest&, const SessionDigest&) = default;
};
SessionDigest digest_of_message(std::span<const std::byte> message);
/// Of a whole session, from the digests of its messages.
SessionDigest digest_of_session(const std::vector<SessionDigest>& messages);

/// What the footer says of a chunk.
struct ChunkEntry {
  std::uint64_t offset = 0;  ///< of its frame in the file
  std::uint64_t size = 0;    ///< of its frame
  std::uint64_t first = 0;   ///< numbers of its first and last tick
  std::uint64_t last = 0;
  std::uint32_t ticks = 0;
  SessionDigest digest;
};

struct SessionFooter {
  std::uint64_t ticks = 0;
  std::uint64_t dropped = 0;
  std::vector<ChunkEntry> chunks;
  SessionDigest digest;
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

/// The end of the file.
inline constexpr std::size_t kLocatorBytes = 24;
struct Locator {
  std::uint64_t footer = 0;  ///< where its frame starts
  std::uint64_t hash = 0;    ///< XXH3-64 of that frame
};
std::array<std::byte, kLocatorBytes> encode_locator(const Locator& locator);
/// False when it is none.
bool decode_locator(std::span<const std::byte, kLocatorBytes> bytes, Locator& locator);
std::uint64_t hash_of_frame(std::span<const std::byte> frame);

/// Bytes of the frame that `bytes` starts with; 0 when none is there as a whole.
std::size_t frame_size(std::span<const std::byte> bytes);
/// The most bytes that a frame with `content` bytes can have.
std::size_t frame_bound(std::uint64_t content);

/// To frames and back, with the contexts kept.
class FrameCodec {
 public:
  FrameCodec();
  ~FrameCodec();
  FrameCodec(FrameCodec&&) noexcept;

  /// The frame is valid until the next call.
  std::span<const std::byte> encode(std::span<const std::byte> content);
  /// A frame without anything behind it. A claim of more than `limit` bytes is refused before
  /// memory is taken for it. @throw FormatError (without the file's name)
  void decode(std::span<const std::byte> frame, std::uint64_t limit, Message& message);

 private:
  ZSTD_CCtx_s* compress_ = nullptr;
  ZSTD_DCtx_s* decompress_ = nullptr;
  std::vector<std::byte> frame_;
};

}  // namespace hapgrid
