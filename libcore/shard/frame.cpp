#include "libcore/shard/frame.hpp"

#define ZSTD_STATIC_LINKING_ONLY  // ZSTD_d_forceIgnoreChecksum
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "libcore/base/error.hpp"

namespace hapgrid {

namespace {

constexpr std::size_t kMinimumRead = 64 << 10;

}  // namespace

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
  if (const std::size_t bound = ZSTD_compressBound(content.size()); bound > capacity_) {
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

FrameDecoder::FrameDecoder(bool hashed) : context_(std::make_unique<Context>()) {
  if (!context_->zstd) throw std::bad_alloc();
  if (hashed)
    ZSTD_DCtx_setParameter(context_->zstd, ZSTD_d_forceIgnoreChecksum, ZSTD_d_ignoreChecksum);
}
FrameDecoder::~FrameDecoder() = default;
FrameDecoder::FrameDecoder(FrameDecoder&&) noexcept = default;

void FrameDecoder::decode(std::span<const std::byte> frame, std::uint64_t limit,
                          std::vector<std::uint64_t>& words) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR)
    throw FormatError("not a shard: a frame without its content's size");
  if (size > limit)
    throw FormatError("a message of " + std::to_string(size) + " bytes, the limit is " +
                      std::to_string(limit));
  if (size == 0 || size % sizeof(std::uint64_t) != 0)
    throw FormatError("not a shard: no Cap'n Proto message");
  words.resize(size / sizeof(std::uint64_t));
  const std::size_t decoded =
      ZSTD_decompressDCtx(context_->zstd, words.data(), size, frame.data(), frame.size());
  if (ZSTD_isError(decoded))
    throw FormatError(std::string("damaged: ") + ZSTD_getErrorName(decoded));
  if (decoded != size) throw FormatError("damaged: a frame is shorter than it says");
}

void FrameReader::fail(const std::string& what) const {
  throw FormatError(file_->name() + ": byte " + std::to_string(offset_) + ": " + what);
}

std::span<const std::byte> FrameReader::next(std::uint64_t limit) {
  const std::uint64_t bound = ZSTD_compressBound(limit) + 64;
  const std::uint64_t left = end_ - offset_;
  if (offset_ < buffer_offset_ || offset_ > buffer_offset_ + buffered_) buffered_ = 0;
  if (buffered_ == 0) buffer_offset_ = offset_;
  for (std::uint64_t want = kMinimumRead;; want *= 2) {
    const auto start = static_cast<std::size_t>(offset_ - buffer_offset_);
    const std::span<const std::byte> bytes(buffer_.data() + start, buffered_ - start);
    static constexpr unsigned char kMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
    if (!bytes.empty() &&
        std::memcmp(bytes.data(), kMagic, std::min(sizeof kMagic, bytes.size())) != 0)
      fail("not a shard: no zstd frame");
    const std::size_t size = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
    if (!ZSTD_isError(size)) {
      offset_ += size;
      return bytes.first(size);
    }
    if (bytes.size() >= left) fail("truncated or damaged: a frame is cut");
    if (bytes.size() >= bound) fail("damaged: a frame is larger than any message can be");
    if (!read_up_to(static_cast<std::size_t>(std::min({left, want, bound}))))
      fail("truncated or damaged: a frame is cut");
  }
}

/// Moves the next frame's beginning to the front of the buffer and fills it up to `size` bytes, if
/// it has fewer; false at the end of the file.
bool FrameReader::read_up_to(std::size_t size) {
  const auto start = static_cast<std::size_t>(offset_ - buffer_offset_);
  if (buffered_ - start >= size) return true;
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(start),
            buffer_.begin() + static_cast<std::ptrdiff_t>(buffered_), buffer_.begin());
  buffered_ -= start;
  buffer_offset_ = offset_;
  buffer_.resize(std::max(buffer_.size(), size));
  const std::size_t count =
      file_->read(offset_ + buffered_, std::span(buffer_).subspan(buffered_, size - buffered_));
  buffered_ += count;
  return count > 0;
}

}  // namespace hapgrid
