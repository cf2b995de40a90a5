#include "libcore/base/frame.hpp"

#define ZSTD_STATIC_LINKING_ONLY  // ZSTD_d_forceIgnoreChecksum
#include <zstd.h>

#include <new>
#include <string>

#include "libcore/base/error.hpp"

namespace hapgrid {

std::size_t frame_size(std::span<const std::byte> bytes) {
  const std::size_t size = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
  return ZSTD_isError(size) ? 0 : size;
}

std::size_t frame_bound(std::uint64_t content) { return ZSTD_compressBound(content) + 64; }

struct FrameEncoder::Context {
  ZSTD_CCtx* zstd = ZSTD_createCCtx();
  ~Context() { ZSTD_freeCCtx(zstd); }
};

FrameEncoder::FrameEncoder(int level) : context_(std::make_unique<Context>()) {
  if (!context_->zstd) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_checksumFlag, 1);
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_contentSizeFlag, 1);
}
FrameEncoder::~FrameEncoder() = default;
FrameEncoder::FrameEncoder(FrameEncoder&&) noexcept = default;

std::span<const std::byte> FrameEncoder::encode(std::span<const std::byte> content) {
  if (const std::size_t bound = frame_bound(content.size()); bound > capacity_) {
    frame_ = std::make_unique_for_overwrite<std::byte[]>(bound);
    capacity_ = bound;
  }
  const std::size_t size =
      ZSTD_compress2(context_->zstd, frame_.get(), capacity_, content.data(), content.size());
  if (ZSTD_isError(size)) throw Error(std::string("zstd: ") + ZSTD_getErrorName(size));
  return {frame_.get(), size};
}

struct FrameDecoder::Context {
  ZSTD_DCtx* zstd = ZSTD_createDCtx();
  ~Context() { ZSTD_freeDCtx(zstd); }
};

FrameDecoder::FrameDecoder(const char* kind, bool hashed)
    : kind_(kind), context_(std::make_unique<Context>()) {
  if (!context_->zstd) throw std::bad_alloc();
  if (hashed)
    ZSTD_DCtx_setParameter(context_->zstd, ZSTD_d_forceIgnoreChecksum, ZSTD_d_ignoreChecksum);
}
FrameDecoder::~FrameDecoder() = default;
FrameDecoder::FrameDecoder(FrameDecoder&&) noexcept = default;

void FrameDecoder::decode(std::span<const std::byte> frame, std::uint64_t limit,
                          std::vector<std::uint64_t>& words) {
  if (frame.empty() || frame_size(frame) != frame.size())
    throw FormatError("damaged: a frame is cut");
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR)
    throw FormatError(std::string("not a ") + kind_ + ": a frame without its content's size");
  if (size > limit)
    throw FormatError("a message of " + std::to_string(size) + " bytes, the limit is " +
                      std::to_string(limit));
  if (size == 0 || size % sizeof(std::uint64_t) != 0)
    throw FormatError(std::string("not a ") + kind_ + ": no Cap'n Proto message");
  words.resize(size / sizeof(std::uint64_t));
  const std::size_t decoded =
      ZSTD_decompressDCtx(context_->zstd, words.data(), size, frame.data(), frame.size());
  if (ZSTD_isError(decoded))
    throw FormatError(std::string("damaged: ") + ZSTD_getErrorName(decoded));
  if (decoded != size) throw FormatError("damaged: a frame is shorter than it says");
}

}  // namespace hapgrid
