// Frames, digests and the end of the file.
#include <xxhash.h>
#include <zstd.h>

#include <bit>
#include <cstring>
#include <new>
#include <utility>

#include "libcore/base/error.hpp"
#include "libcore/session/format.hpp"

namespace hapgrid {

static_assert(std::endian::native == std::endian::little,
              "digests and the locator are as they are in memory");

namespace {

// The slow thread has time, and a session is kept: zstd's own default.
constexpr int kCompressionLevel = 3;

constexpr std::uint32_t kLocatorMagic = 0x184D2A5E;  // a skippable frame
constexpr std::uint32_t kLocatorContent = 16;

SessionDigest digest_of_bytes(const void* bytes, std::size_t size) {
  const XXH128_hash_t hash = XXH3_128bits(bytes, size);
  return {hash.low64, hash.high64};
}

}  // namespace

SessionDigest digest_of_message(std::span<const std::byte> message) {
  return digest_of_bytes(message.data(), message.size());
}

SessionDigest digest_of_session(const std::vector<SessionDigest>& messages) {
  static_assert(sizeof(SessionDigest) == 16);
  return digest_of_bytes(messages.data(), messages.size() * sizeof(SessionDigest));
}

std::uint64_t hash_of_frame(std::span<const std::byte> frame) {
  return XXH3_64bits(frame.data(), frame.size());
}

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

std::size_t frame_size(std::span<const std::byte> bytes) {
  const std::size_t size = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
  return ZSTD_isError(size) ? 0 : size;
}

std::size_t frame_bound(std::uint64_t content) { return ZSTD_compressBound(content) + 64; }

FrameCodec::FrameCodec() : compress_(ZSTD_createCCtx()), decompress_(ZSTD_createDCtx()) {
  if (!compress_ || !decompress_) {
    ZSTD_freeCCtx(compress_);
    ZSTD_freeDCtx(decompress_);
    throw std::bad_alloc();
  }
  ZSTD_CCtx_setParameter(compress_, ZSTD_c_compressionLevel, kCompressionLevel);
  ZSTD_CCtx_setParameter(compress_, ZSTD_c_checksumFlag, 1);
  ZSTD_CCtx_setParameter(compress_, ZSTD_c_contentSizeFlag, 1);
}

FrameCodec::~FrameCodec() {
  ZSTD_freeCCtx(compress_);
  ZSTD_freeDCtx(decompress_);
}

FrameCodec::FrameCodec(FrameCodec&& other) noexcept
    : compress_(std::exchange(other.compress_, nullptr)),
      decompress_(std::exchange(other.decompress_, nullptr)),
      frame_(std::move(other.frame_)) {}

std::span<const std::byte> FrameCodec::encode(std::span<const std::byte> content) {
  if (const std::size_t bound = frame_bound(content.size()); frame_.size() < bound)
    frame_.resize(bound);
  const std::size_t size =
      ZSTD_compress2(compress_, frame_.data(), frame_.size(), content.data(), content.size());
  if (ZSTD_isError(size)) throw Error(std::string("zstd: ") + ZSTD_getErrorName(size));
  return {frame_.data(), size};
}

void FrameCodec::decode(std::span<const std::byte> frame, std::uint64_t limit, Message& message) {
  if (frame_size(frame) != frame.size() || frame.empty())
    throw FormatError("damaged: a frame is cut");
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR)
    throw FormatError("not a session: a frame without its content's size");
  if (size > limit)
    throw FormatError("a message of " + std::to_string(size) + " bytes, the limit is " +
                      std::to_string(limit));
  if (size == 0 || size % sizeof(std::uint64_t) != 0)
    throw FormatError("not a session: no Cap'n Proto message");
  message.resize(size / sizeof(std::uint64_t));
  const std::size_t decoded =
      ZSTD_decompressDCtx(decompress_, message.data(), size, frame.data(), frame.size());
  if (ZSTD_isError(decoded))
    throw FormatError(std::string("damaged: ") + ZSTD_getErrorName(decoded));
  if (decoded != size) throw FormatError("damaged: a frame is shorter than it says");
}

}  // namespace hapgrid
