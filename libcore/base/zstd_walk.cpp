#include "libcore/base/zstd_walk.hpp"

#define ZSTD_STATIC_LINKING_ONLY  // ZSTD_getFrameHeader
#include <zstd.h>

#include <algorithm>

namespace hapgrid {

namespace {

constexpr std::size_t kMagicBytes = 4;
constexpr std::size_t kBlockHeaderBytes = 3;
constexpr std::uint32_t kChecksumBytes = 4;

std::uint32_t number(std::span<const std::byte> bytes) {  // little-endian
  std::uint32_t n = 0;
  for (std::size_t i = bytes.size(); i-- > 0;)
    n = n << 8 | std::to_integer<std::uint32_t>(bytes[i]);
  return n;
}

}  // namespace

bool ZstdWalk::take(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::size_t skipped = std::min<std::uint64_t>(skip_, bytes.size());
    skip_ -= skipped;
    bytes = bytes.subspan(skipped);
    if (bytes.empty()) break;
    head_[size_++] = bytes.front();
    bytes = bytes.subspan(1);
    if (!(in_frame_ ? end_of_block_header() : end_of_frame_header())) return false;
  }
  return true;
}

/// Looks whether head_ holds a whole header. False when it cannot become one.
bool ZstdWalk::end_of_frame_header() {
  if (size_ < kMagicBytes) return true;
  const std::uint32_t magic = number(std::span(head_).first(kMagicBytes));
  if (magic != ZSTD_MAGICNUMBER &&
      (magic & ZSTD_MAGIC_SKIPPABLE_MASK) != ZSTD_MAGIC_SKIPPABLE_START)
    return false;
  ZSTD_frameHeader header;
  const std::size_t lacks = ZSTD_getFrameHeader(&header, head_.data(), size_);
  if (ZSTD_isError(lacks)) return false;
  if (lacks > 0) return size_ < head_.size();
  size_ = 0;
  if (header.frameType == ZSTD_skippableFrame) {
    skip_ = header.frameContentSize;
  } else {
    in_frame_ = true;
    has_checksum_ = header.checksumFlag != 0;
  }
  return true;
}

/// RFC 8878, section 3.1.1.2: whether it is the last, the type, and the size, of 1, 2 and 21 bits.
bool ZstdWalk::end_of_block_header() {
  if (size_ < kBlockHeaderBytes) return true;
  const std::uint32_t header = number(std::span(head_).first(kBlockHeaderBytes));
  const std::uint32_t type = header >> 1 & 3, size = header >> 3;
  constexpr std::uint32_t kRepeated = 1, kReserved = 3;
  if (type == kReserved || size > ZSTD_BLOCKSIZE_MAX) return false;
  skip_ = type == kRepeated ? 1 : size;
  if (header & 1) {
    in_frame_ = false;
    if (has_checksum_) skip_ += kChecksumBytes;
  }
  size_ = 0;
  return true;
}

}  // namespace hapgrid
